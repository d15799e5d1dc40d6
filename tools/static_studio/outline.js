/** Outline: what the lines of a drawing enclose, past gaps, as normalgan.inference.mask.filling does it in Python. */

import { snap } from "./edge.js";
import { lineWidth } from "./prepare.js";
import { boxOf, components, enclosedBy, resized, thicker, where } from "./raster.js";

const SIDE = 512;
/** Half the widths of the gaps that thick lines close, and the costs of bridges, as shares of the span. */
const STEPS = [[0, 0], [0.005, 0], [0.012, 0], [0.005, 0.08], [0.005, 0.16], [0.005, 0.25], [0.022, 0.25], [0.035, 0.25]];
const MARGIN = 0.035;
const [OFF, LEAST_OFF] = [2.5, 2];
const [ENOUGH, FAILED, BELIEVED, DEAREST] = [0.93, 0.5, 0.8, 3];
const [ONTO, NEAR, WAYS, MOST] = [1.3, 0.2, 3, 400];
const FAN = [-45, -30, -15, 0, 15, 30, 45].map((angle) => (angle * Math.PI) / 180);

/** @typedef {{x: number, y: number, dx: number, dy: number}} End where a line stops, and the way out of it */
/** @typedef {{x: number, y: number, toX: number, toY: number, cost: number}} Bridge */

/**
 * Returns the mask of an outline, how much of each pixel it covers, how much of the ink encloses anything, and whether a wide gap was closed.
 * @param {Float32Array} ink @param {number} width @param {number} height
 */
export function fillOutline(ink, width, height) {
  const scale = Math.min(Math.max(width, height, SIDE / 2), SIDE) / Math.max(width, height);
  const [wide, high] = [width, height].map((side) => Math.max(1, Math.round(side * scale)));
  const small = scale === 1 ? ink : resized(ink, width, height, wide, high);
  const box = boxOf(small, wide, high, 0.35);
  if (!box) return { mask: new Uint8Array(width * height), covered: new Float32Array(width * height), closed: 0, guessed: false };
  const span = Math.max(box[2] - box[0], box[3] - box[1]);
  const margin = Math.floor(MARGIN * span) + 2;
  const [padded, rows] = [wide + 2 * margin, high + 2 * margin];
  const inked = new Uint8Array(padded * rows);
  for (let y = 0; y < high; y++) {
    for (let x = 0; x < wide; x++) inked[(y + margin) * padded + x + margin] = small[y * wide + x] > 0.35 ? 1 : 0;
  }
  const filling = new Filling(inked, padded, rows, span);
  filling.fill();
  const guessed = filling.closed < FAILED && filling.guess();
  const filled = filling.mask();
  let mask = new Uint8Array(wide * high);
  for (let y = 0; y < high; y++) mask.set(filled.subarray((y + margin) * padded + margin, (y + margin) * padded + margin + wide), y * wide);
  if (scale !== 1) mask = where(resized(mask, wide, high, width, height), (value) => value > 0.5);
  // At that size the edge is off by some of its pixels.
  const covered = snap(mask, ink, width, height, Math.max((OFF * Math.max(width, height)) / SIDE, LEAST_OFF));
  return { mask: where(covered, (value) => value > 0.5), covered, closed: filling.closed, guessed };
}

/** An inside that grows while gaps are closed. */
class Filling {
  /** @param {Uint8Array} inked @param {number} width @param {number} height @param {number} span */
  constructor(inked, width, height, span) {
    this.inked = inked;
    this.width = width;
    this.height = height;
    this.span = span;
    this.lines = inked.slice();
    this.inside = new Uint8Array(inked.length);
    this.line = lineWidth(inked, width, height);
    this.count = inked.reduce((sum, value) => sum + value, 0);
    this.closed = 0;
  }

  /** Closes gaps, small ones first, until nearly all lines enclose something. */
  fill() {
    /** @type {Bridge[] | null} */
    let found = null;
    let built = 0;
    for (const [gap, cost] of STEPS) {
      if (cost && !found) found = this.bridges(0.25 * this.span);
      const wanted = (found ?? []).filter((each) => each.cost <= cost * this.span);
      for (const each of wanted.slice(built)) this.build(each);
      this.take(gap * this.span);
      built = wanted.length;
      if (this.closed > ENOUGH) break;
    }
  }

  /** Bridges gaps of nearly any width; returns whether that helped. */
  guess() {
    const before = this.closed;
    for (const bridge of this.bridges(DEAREST * this.span)) {
      if (this.closed >= BELIEVED) break;
      this.build(bridge);
      this.take(0);
    }
    return this.closed > before;
  }

  /** Returns the inside with its lines, and the long lines that hang on it. */
  mask() {
    if (!this.inside.some(Boolean)) return this.inside;
    const whole = this.whole();
    const { width, height } = this;
    const { labels, boxes } = components(where(this.inked, (value, i) => value > 0 && !whole[i]), width, height, 8);
    const around = thicker(whole, width, height, Math.max(Math.round(0.03 * this.span), 1));
    const begins = new Uint8Array(boxes.length);
    labels.forEach((label, i) => { if (around[i]) begins[label] = 1; });
    const long = boxes.map((box, i) => i > 0 && Math.hypot(box.right - box.left, box.bottom - box.top) >= 0.12 * this.span);
    const limbs = where(whole, (_, i) => long[labels[i]] && begins[labels[i]] > 0);
    const shown = this.line >= 2.5 ? limbs : thicker(limbs, width, height, 1.4);
    return where(whole, (value, i) => value > 0 || shown[i] > 0);
  }

  whole() {
    const near = this.near();
    const barrier = where(this.inside, (value, i) => value > 0 || (this.lines[i] > 0 && near[i] > 0));
    return enclosedBy(barrier, this.width, this.height);
  }

  near() {
    return thicker(this.inside, this.width, this.height, this.line + 1.5);
  }

  /** @param {Bridge} bridge */
  build({ x, y, toX, toY }) {
    const count = Math.max(Math.abs(toX - x), Math.abs(toY - y), 1);
    for (let i = 0; i <= count; i++) {
      const [column, row] = [Math.round(x + (i / count) * (toX - x)), Math.round(y + (i / count) * (toY - y))];
      this.lines[row * this.width + column] = 1;
    }
  }

  /** Adds what is enclosed by lines made thicker. @param {number} gap */
  take(gap) {
    const { width, height } = this;
    const thick = thicker(this.lines, width, height, gap);
    const enclosed = enclosedBy(thick, width, height);
    let fresh = where(enclosed, (value, i) => value > 0 && !thick[i] && !this.inside[i]);
    if (!fresh.some(Boolean)) return;
    if (gap) fresh = this.grown(fresh, gap);
    for (let i = 0; i < fresh.length; i++) if (fresh[i]) this.inside[i] = 1;
    const near = this.near();
    this.closed = this.inked.reduce((sum, value, i) => sum + (value && near[i] ? 1 : 0), 0) / this.count;
  }

  /** Returns seeds with all within reach that is not behind a line. @param {Uint8Array} seeds @param {number} reach */
  grown(seeds, reach) {
    const { width, height } = this;
    const room = thicker(seeds, width, height, reach + 0.5);
    const grown = seeds.slice();
    let edge = [...seeds.keys()].filter((at) => seeds[at]);
    for (let step = 0; step < Math.ceil(reach * Math.SQRT2); step++) {
      const next = [];
      for (const at of edge) {
        for (const other of [at - 1, at + 1, at - width, at + width]) {
          if (grown[other] || !room[other] || this.lines[other]) continue;
          grown[other] = 1;
          next.push(other);
        }
      }
      edge = next;
    }
    return grown;
  }

  /** Returns bridges from the ends of lines that are not inside anyway, the cheapest first. @param {number} most @returns {Bridge[]} */
  bridges(most) {
    const whole = this.whole();
    const ahead = this.line + 1;
    const ends = this.ends().filter(({ x, y, dx, dy }) => {
      const column = Math.max(0, Math.min(this.width - 1, Math.round(x + ahead * dx)));
      const row = Math.max(0, Math.min(this.height - 1, Math.round(y + ahead * dy)));
      return !whole[row * this.width + column];
    });
    if (ends.length > MOST) return [];
    const candidates = [...this.toEnds(ends, most), ...this.toLines(ends, Math.min(NEAR * this.span, most))];
    candidates.sort((a, b) => a.cost - b.cost);
    const built = ends.map(() => 0);
    return candidates.filter(({ own, other, x, y, toX, toY }) => {
      const both = other < 0 ? [own] : [own, other];
      if (both.some((each) => built[each] >= WAYS)) return false;
      if (other >= 0 && this.crosses(x, y, toX, toY)) return false;
      for (const each of both) built[each]++;
      return true;
    });
  }

  /** @param {End[]} ends @param {number} most */
  *toEnds(ends, most) {
    for (let own = 0; own < ends.length; own++) {
      for (let other = own + 1; other < ends.length; other++) {
        const [a, b] = [ends[own], ends[other]];
        const [x, y] = [b.x - a.x, b.y - a.y];
        const length = Math.hypot(x, y);
        const turn = (x * a.dx + y * a.dy - x * b.dx - y * b.dy) / Math.max(length, 1e-6);
        const cost = length * (3 - turn);
        if (cost <= most) yield { cost, own, other, x: a.x, y: a.y, toX: b.x, toY: b.y };
      }
    }
  }

  /** @param {End[]} ends @param {number} most */
  *toLines(ends, most) {
    const reach = Math.floor(most / ONTO);
    for (const [own, { x, y, dx, dy }] of ends.entries()) {
      for (const angle of FAN) {
        const [cosine, sine] = [Math.cos(angle), Math.sin(angle)];
        const [right, down] = [dx * cosine - dy * sine, dx * sine + dy * cosine];
        for (let step = 2; step <= reach; step++) {
          const [toX, toY] = [Math.round(x + right * step), Math.round(y + down * step)];
          if (toX < 0 || toY < 0 || toX >= this.width || toY >= this.height) break;
          if (!this.inked[toY * this.width + toX]) continue;
          const cost = ONTO * step * (2 - cosine);
          if (cost <= most) yield { cost, own, other: -1, x, y, toX, toY };
          break;
        }
      }
    }
  }

  /** @param {number} x @param {number} y @param {number} toX @param {number} toY */
  crosses(x, y, toX, toY) {
    const count = Math.max(Math.abs(toX - x), Math.abs(toY - y));
    const beside = Math.floor(this.line) + 2;
    for (let i = beside; i <= count - beside; i++) {
      const [column, row] = [Math.round(x + (i / count) * (toX - x)), Math.round(y + (i / count) * (toY - y))];
      if (this.inked[row * this.width + column]) return true;
    }
    return false;
  }

  /** Returns where lines stop: there a ring crosses ink once, and on a short arc. @returns {End[]} */
  ends() {
    const { inked, width, height } = this;
    const radius = 1.5 * this.line + 2;
    /** @type {[number, number][]} */
    const ring = [];
    for (let angle = 0; angle < 2 * Math.PI; angle += 0.01 / radius) {
      const [dx, dy] = [Math.round(radius * Math.cos(angle)), Math.round(radius * Math.sin(angle))];
      const last = ring.at(-1);
      if (!last || last[0] !== dx || last[1] !== dy) ring.push([dx, dy]);
    }
    if (ring.length > 1 && ring[0][0] === ring.at(-1)?.[0] && ring[0][1] === ring.at(-1)?.[1]) ring.pop();
    const mark = new Uint8Array(inked.length);
    /** @type {Map<number, [number, number]>} */
    const backs = new Map();
    for (let at = 0; at < inked.length; at++) {
      if (!inked[at]) continue;
      const [x, y] = [at % width, Math.floor(at / width)];
      let [arcs, share, right, down] = [0, 0, 0, 0];
      const on = ring.map(([dx, dy]) => (x + dx >= 0 && y + dy >= 0 && x + dx < width && y + dy < height ? inked[at + dy * width + dx] : 0));
      for (let k = 0; k < on.length; k++) {
        if (on[k] > on[(k + on.length - 1) % on.length]) arcs++;
        if (!on[k]) continue;
        share++;
        right += ring[k][0];
        down += ring[k][1];
      }
      if (arcs !== 1 || share > ring.length / 3) continue;
      mark[at] = 1;
      backs.set(at, [right / share, down / share]);
    }
    const { labels, boxes } = components(mark, width, height, 8);
    const ways = boxes.map(() => [0, 0]);
    for (const [at, [right, down]] of backs) {
      ways[labels[at]][0] -= right;
      ways[labels[at]][1] -= down;
    }
    /** @type {(End & {far: number})[]} */
    const tips = [];
    for (const at of backs.keys()) {
      const [right, down] = ways[labels[at]];
      const length = Math.max(Math.hypot(right, down), 1e-6);
      const [x, y, dx, dy] = [at % width, Math.floor(at / width), right / length, down / length];
      const far = x * dx + y * dy;
      if (!(tips[labels[at]]?.far >= far)) tips[labels[at]] = { x, y, dx, dy, far };
    }
    return tips.filter(Boolean);
  }
}

