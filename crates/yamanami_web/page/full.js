// Full screen, on and off.

import { t } from './i18n.js';
import { say } from './messages.js';

export async function toggleFull() {
  try {
    if (document.fullscreenElement) await document.exitFullscreen();
    else await document.documentElement.requestFullscreen();
  } catch {
    say(t('full_failed'), { kind: 'full' });
  }
}
