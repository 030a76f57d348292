// Help: how to get about.

import { onLanguage, t } from './i18n.js';
import { make } from './widgets.js';

/** Words of what is done and what it does: keys of the dictionary. */
const LISTS = [
  ['help_pointer', [['help_drag', 'help_drag_what'], ['help_right', 'help_right_what'], ['help_wheel', 'help_wheel_what'], ['help_double', 'help_double_what'], ['help_tap', 'help_tap_what']]],
  ['help_touch', [['help_one', 'help_one_what'], ['help_two', 'help_two_what']]],
  ['help_keys', [
    ['help_move', 'help_move_what'], ['help_updown', 'help_updown_what'], ['help_zoom', 'help_wheel_what'], ['help_home', 'home'], ['help_fly', 'fly'],
    ['help_map', 'map_mode'], ['help_profile', 'profile_tool'], ['help_colour', 'help_colour_what'], ['help_edges', 'wireframe'],
    ['help_enter', 'help_enter_what'], ['help_escape', 'help_escape_what'], ['help_question', 'help'],
  ]],
];

/** Words without the key that stands behind them in brackets. */
const bare = (key) => t(key).replace(/\s*\([A-Z?+−]\)$/, '');

function fill(dialog) {
  const close = make('button', { type: 'button', textContent: t('help_close') });
  close.addEventListener('click', () => dialog.close());
  const lists = LISTS.flatMap(([title, rows]) => [
    make('h3', { textContent: t(title) }),
    make('dl', {}, ...rows.flatMap(([what, does]) => [make('dt', { textContent: t(what) }), make('dd', { textContent: bare(does) })])),
  ]);
  dialog.replaceChildren(make('h2', { id: 'help-title', textContent: t('help_title') }), make('div', { className: 'lists' }, ...lists), close);
}

/** Shows the help, or closes it. */
export function toggleHelp() {
  const dialog = document.getElementById('help');
  if (dialog.open) return dialog.close();
  fill(dialog);
  dialog.showModal();
}

onLanguage(() => {
  const dialog = document.getElementById('help');
  if (dialog.open) fill(dialog);
});
