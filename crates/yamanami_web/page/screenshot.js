// A picture of the view as a PNG, with title and credit.

import { download } from './download.js';
import { density } from './loop.js';

/** The picture as a blob. The canvas is drawn in the same turn: later its pixels are gone. */
export function takePicture({ canvas, marks, draw, title, credit }) {
  draw();
  const picture = document.createElement('canvas');
  Object.assign(picture, { width: canvas.width, height: canvas.height });
  const pen = picture.getContext('2d');
  pen.drawImage(canvas, 0, 0);
  pen.drawImage(marks, 0, 0, picture.width, picture.height);
  const unit = density();
  const write = (text, y, size, weight) => {
    pen.font = `${weight} ${size * unit}px system-ui, sans-serif`;
    pen.lineJoin = 'round';
    pen.lineWidth = 4 * unit;
    pen.strokeStyle = 'rgba(255, 255, 255, 0.85)';
    pen.strokeText(text, 16 * unit, y);
    pen.fillStyle = '#1b2321';
    pen.fillText(text, 16 * unit, y);
  };
  const bottom = picture.height - 16 * unit;
  write(title, credit ? bottom - 18 * unit : bottom, 20, 600);
  if (credit) write(credit, bottom, 12, 400);
  return new Promise((resolve, reject) => {
    picture.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('PNG'))), 'image/png');
  });
}

export async function savePicture(what, name) {
  const blob = await takePicture(what);
  download(blob, `${name}.png`);
  return blob;
}
