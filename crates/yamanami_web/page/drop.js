// Files dropped on the page.

/** `take(files)` hears of them; a cover shows that they may be let go. */
export function hearDrops(take) {
  const cover = document.getElementById('drop');
  const isFiles = (event) => event.dataTransfer?.types.includes('Files');
  addEventListener('dragover', (event) => {
    if (!isFiles(event)) return;
    event.preventDefault();
    cover.hidden = false;
  });
  addEventListener('dragleave', (event) => {
    if (!event.relatedTarget) cover.hidden = true;
  });
  addEventListener('drop', (event) => {
    if (!isFiles(event)) return;
    event.preventDefault();
    cover.hidden = true;
    take([...event.dataTransfer.files]);
  });
}
