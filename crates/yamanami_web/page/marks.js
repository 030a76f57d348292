// What is drawn over the picture: lines and places of files, the profile, the place that was tapped.

import { density } from './loop.js';

const PAPER = 'rgba(255, 255, 255, 0.9)';
const INK = '#1b2321';
const PROFILE = '#b3261e';

export class Marks {
  #canvas;
  #pen;
  /** The place that was tapped, local, or null. */
  tapped = null;

  constructor(canvas) {
    this.#canvas = canvas;
    this.#pen = canvas.getContext('2d');
  }

  /** Draws everything anew for the view as it is. */
  draw(viewer, files, profile) {
    const box = this.#canvas.parentElement;
    const [width, height] = [box.clientWidth, box.clientHeight].map((length) => Math.max(1, Math.round(length * density())));
    if (this.#canvas.width !== width || this.#canvas.height !== height) Object.assign(this.#canvas, { width, height });
    const pen = this.#pen;
    pen.clearRect(0, 0, width, height);
    pen.lineJoin = pen.lineCap = 'round';
    for (const file of files) for (const line of file.onLand) this.#line(viewer, line, file.colour, 3);
    if (profile) this.#line(viewer, profile.line, PROFILE, 2.5);
    const taken = [];
    for (const file of files) this.#places(viewer, file, taken);
    if (profile) this.#dots(viewer, profile.places, PROFILE, 4.5);
    if (profile?.cursor) this.#dots(viewer, profile.cursor, '#ffffff', 5.5, PROFILE);
    if (this.tapped && !profile) this.#dots(viewer, this.tapped, INK, 4.5);
  }

  #line(viewer, points, colour, widthPx) {
    if (points.length < 6) return;
    const screen = viewer.to_screen(points);
    const path = new Path2D();
    let isOpen = false;
    for (let i = 0; i + 2 < screen.length; i += 3) {
      const isSeen = screen[i + 2] === 1;
      if (isSeen && isOpen) path.lineTo(screen[i], screen[i + 1]);
      else if (isSeen) path.moveTo(screen[i], screen[i + 1]);
      isOpen = isSeen;
    }
    for (const [style, more] of [[PAPER, 2.5], [colour, 0]]) {
      this.#pen.strokeStyle = style;
      this.#pen.lineWidth = (widthPx + more) * density();
      this.#pen.stroke(path);
    }
  }

  #dots(viewer, points, colour, radiusPx, ring = PAPER) {
    const screen = viewer.to_screen(new Float64Array(points));
    for (let i = 0; i + 2 < screen.length; i += 3) if (screen[i + 2] === 1) this.#dot(screen[i], screen[i + 1], colour, radiusPx, ring);
  }

  #dot(x, y, colour, radiusPx, ring) {
    const pen = this.#pen;
    pen.beginPath();
    pen.arc(x, y, radiusPx * density(), 0, 2 * Math.PI);
    pen.fillStyle = colour;
    pen.fill();
    pen.lineWidth = 2 * density();
    pen.strokeStyle = ring;
    pen.stroke();
  }

  /** Dots with names; names that would lie over others are left out. */
  #places(viewer, file, taken) {
    if (file.places.length === 0) return;
    const pen = this.#pen;
    const size = 13 * density();
    pen.font = `600 ${size}px system-ui, sans-serif`;
    pen.textBaseline = 'middle';
    const screen = viewer.to_screen(file.marks);
    file.places.forEach(({ name }, i) => {
      const [x, y, seen] = screen.subarray(3 * i, 3 * i + 3);
      if (seen !== 1) return;
      this.#dot(x, y, file.colour, 4.5, PAPER);
      const box = [x + 9 * density(), y - size, x + 9 * density() + pen.measureText(name).width, y + size];
      if (!name || taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) return;
      taken.push(box);
      pen.lineWidth = 4 * density();
      pen.strokeStyle = PAPER;
      pen.strokeText(name, box[0], y);
      pen.fillStyle = INK;
      pen.fillText(name, box[0], y);
    });
  }
}
