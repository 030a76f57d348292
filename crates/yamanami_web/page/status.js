// The progress of loading, and the running numbers.

import * as format from './format.js';
import { t } from './i18n.js';

/** The numbers change this often. */
const EVERY_MS = 250;
let shownMs = 0;

/** Bytes received of those wanted; null while nothing is known. */
export function showProgress(progress) {
  const bar = document.getElementById('loading');
  bar.hidden = progress !== null && progress.is_complete;
  if (bar.hidden) return;
  const [received, wanted] = progress ? [progress.received_bytes, Math.max(progress.wanted_bytes, progress.received_bytes)] : [0, 0];
  const share = wanted > 0 ? received / wanted : 0;
  bar.querySelector('.bar').style.width = `${100 * share}%`;
  const words = wanted > 0 ? t('loading_share', { received: format.bytes(received), wanted: format.bytes(wanted) }) : t('starting');
  bar.querySelector('.text').textContent = words;
  bar.setAttribute('aria-valuenow', String(Math.round(100 * share)));
  bar.setAttribute('aria-valuetext', words);
}

export function showStats(viewer, nowMs, isLast) {
  if (nowMs - shownMs < EVERY_MS && !isLast) return;
  shownMs = nowMs;
  const stats = JSON.parse(viewer.stats());
  const words = {
    triangles: format.number(stats.triangles),
    error: format.short(stats.error_left),
    unit: stats.unit ?? '',
    update: format.number(stats.update_ms, 1),
    draw: format.number(stats.draw_ms, 1),
  };
  const by = stats.limited_by ? t('comma') + t('limited', { by: t(`by_${stats.limited_by}`) }) : '';
  const steps = stats.thresholds_m?.length ? ` · f: ${stats.thresholds_m.map(format.short).join(' | ')} m` : '';
  const line = document.getElementById('stats');
  line.classList.toggle('fault', Boolean(stats.fault));
  line.textContent = stats.fault ?? t('stats', words) + by + steps;
}
