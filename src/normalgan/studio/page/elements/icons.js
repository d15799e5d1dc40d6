/** Icons: lines on a grid of 24, in the colour of the text. */

/** @type {Record<string, string>} */
const paths = {
  new: "M6 3h8l4 4v14H6z M14 3v4h4 M12 11v6 M9 14h6",
  open: "M3 19V6h6l2 2h8v3 M3 19l3-8h16l-3 8z",
  save: "M4 4h13l3 3v13H4z M8 4v5h8V4 M8 20v-6h8v6",
  import: "M12 4v10 M8 10l4 4 4-4 M4 15v5h16v-5",
  export: "M12 15V4 M8 8l4-4 4 4 M4 15v5h16v-5",
  undo: "M9 6L4 11l5 5 M4 11h10a5.5 5.5 0 0 1 0 9h-3",
  redo: "M15 6l5 5-5 5 M20 11H10a5.5 5.5 0 0 0 0 9h3",
  history: "M4 12a8 8 0 1 0 2.4-5.7 M4 4v4h4 M12 8v4.5l3 2",
  theme: "M12 3a9 9 0 1 0 0 18z M12 3a9 9 0 0 1 0 18",
  help: "M9 9.2a3 3 0 1 1 4.6 2.6c-1 .7-1.6 1.2-1.6 2.4 M12 17.6v.2 M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18z",
  pen: "M4 20l1.2-4.6L16.4 4.2a1.9 1.9 0 0 1 2.7 0l.7.7a1.9 1.9 0 0 1 0 2.7L8.6 18.8z M14.2 6.4l3.4 3.4",
  eraser: "M8.5 19.5L3.7 14.7a1.6 1.6 0 0 1 0-2.3l7.9-7.9a1.6 1.6 0 0 1 2.3 0l5.6 5.6a1.6 1.6 0 0 1 0 2.3l-7.1 7.1z M7.6 8.5l7.9 7.9 M8.5 19.5H20",
  hint: "M12 21a6.5 6.5 0 1 0 0-13 6.5 6.5 0 0 0 0 13z M12 14.5L19.5 4 M15.6 4.6L19.5 4l.7 3.9",
  region: "M12 4c5 0 8 2.4 8 5.4s-3.2 5-7.4 5-8.6-1.8-8.6-4.8S7.4 4 12 4z M12.6 14.4c-3 1-4.6 2.4-3.8 4.2.6 1.4 2.6 1.6 3.4.4",
  brush: "M20 4c-4 1.6-8.4 5.4-10.4 8.8l1.8 1.8C14.8 12.6 18.4 8.2 20 4z M8.6 13.8c-2.4 0-3.4 1.6-3.4 3.6 0 1-.6 1.8-1.6 2.2 3.6 1 7.4.2 7.4-3.6",
  smooth: "M3 9c2-4 4-4 6 0s4 4 6 0 4-4 6 0 M3 16c6-2.5 12-2.5 18 0",
  structure: "M3 5c1.5 3.5 4.5 3.5 6 0 1.5 3.5 4.5 3.5 6 0 1.5 3.5 4.5 3.5 6 0 M6 11c1.5 3.5 4.5 3.5 6 0 1.5 3.5 4.5 3.5 6 0 M3 16.5c1.5 3.5 4.5 3.5 6 0 1.5 3.5 4.5 3.5 6 0 1.5 3.5 4.5 3.5 6 0",
  engrave: "M3 8h4c2 0 2 9 5 9s3-9 5-9h4",
  emboss: "M3 16h4c2 0 2-9 5-9s3 9 5 9h4",
  none: "M3 15c3-8 6-8 9-4s5 3 9-3",
  round: "M3 18a9 11 0 0 1 18 0z",
  flat: "M3 18l4-8h10l4 8z",
  hollow: "M2 8h3c1 11 13 11 14 0h3",
  hand: "M12 3v18 M3 12h18 M9.5 5.5L12 3l2.5 2.5 M9.5 18.5L12 21l2.5-2.5 M5.5 9.5L3 12l2.5 2.5 M18.5 9.5L21 12l-2.5 2.5",
  select: "M5 3l13 8-6 1.5L9 18.5z M13 13l5 6",
  lasso: "M10 4.2c1.4-.2 2.8-.2 4 0 M17.5 5.4c1.7.9 2.8 2.2 3 3.6 M19.8 11.8c-.8 1.2-2.2 2-4 2.5 M12.5 14.8c-1.5 0-3-.2-4.2-.6 M5.3 12.7c-1.2-1-1.8-2.2-1.8-3.5 M4.7 6.8c.6-.7 1.4-1.2 2.3-1.6 M6.5 14.5c-.8 2 .2 3.8-1 5.5",
  split: "M12 3l8 4.5-8 4.5-8-4.5z M4 15l8 4.5 3-1.7 M18 13v7 M14.5 16.5h7",
  straight: "M5 19L19 5 M3.5 19a1.5 1.5 0 1 0 3 0 1.5 1.5 0 0 0-3 0z M17.5 5a1.5 1.5 0 1 0 3 0 1.5 1.5 0 0 0-3 0z",
  symmetry: "M12 3v18 M9 7L3.5 17H9z M15 7l5.5 10H15z",
  mask: "M12 4c4.4 0 8 3.2 8 7.4S16.6 20 12 20s-8-4.2-8-8.6S7.6 4 12 4z M8 12h8 M12 8v8",
  add: "M12 5v14 M5 12h14",
  cut: "M5 12h14",
  area: "M5 8c4-5 12-4 14 1s-2 10-8 10-9-6-6-11z M12 11l6 6 M18 13.5V17h-3.5",
  light: "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8z M12 2.5v2.2 M12 19.3v2.2 M2.5 12h2.2 M19.3 12h2.2 M5.3 5.3l1.5 1.5 M17.2 17.2l1.5 1.5 M18.7 5.3l-1.5 1.5 M6.8 17.2l-1.5 1.5",
  play: "M7 4.5v15l12-7.5z",
  compare: "M4 5h16v14H4z M12 3v18 M15 9h2 M15 12h2 M15 15h2",
  lines: "M4 5h16v14H4z M7 15c2-6 4-6 5-3s3 2 5-3",
  tiled: "M4 4h16v16H4z M4 9.3h16 M4 14.7h16 M9.3 4v16 M14.7 4v16",
  pixelated: "M4 4h16v16H4z M4 12h16 M12 4v16 M4 4h8v8H4z M12 12h8v8h-8z M6 8h4 M14 16h4",
  doubt: "M12 4a8 8 0 1 0 0 16 8 8 0 0 0 0-16z M12 8v5 M12 16v.2",
  layer: "M12 4l9 5-9 5-9-5z M3 14l9 5 9-5",
  paper: "M5 3.5h14v17H5z M8 16l3-4 2.5 2.5L15.5 12l1.5 4z M9 8.5h.2",
  up: "M12 20V5 M6 11l6-6 6 6",
  down: "M12 4v15 M6 13l6 6 6-6",
  eye: "M2.5 12C5 7.5 8.3 5.5 12 5.5s7 2 9.5 6.5c-2.5 4.5-5.8 6.5-9.5 6.5S5 16.5 2.5 12z M12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
  eyeOff: "M3 10c2.4 3.4 5.4 5 9 5s6.6-1.6 9-5 M12 15v3.5 M6.5 13.5L4.5 16.5 M17.5 13.5l2 3",
  zoomIn: "M10.5 4a6.5 6.5 0 1 0 0 13 6.5 6.5 0 0 0 0-13z M15.3 15.3L21 21 M10.5 7.5v6 M7.5 10.5h6",
  zoomOut: "M10.5 4a6.5 6.5 0 1 0 0 13 6.5 6.5 0 0 0 0-13z M15.3 15.3L21 21 M7.5 10.5h6",
  fit: "M4 9V4h5 M20 9V4h-5 M4 15v5h5 M20 15v5h-5",
  suggest: "M12 3v4 M12 17v4 M3 12h4 M17 12h4 M6 6l2.2 2.2 M15.8 15.8L18 18 M18 6l-2.2 2.2 M8.2 15.8L6 18",
  remove: "M5 7h14 M10 7V4h4v3 M7 7l1 13h8l1-13 M10.5 11v5 M13.5 11v5",
  flip: "M12 3v18 M9 7L3.5 17H9z M15 7v10h5.5z",
  flipDown: "M3 12h18 M7 9L17 3.5V9z M7 15h10v5.5z",
  turn: "M19.5 12a7.5 7.5 0 1 1-2.3-5.4 M19.5 3v4.5H15",
  copy: "M9 9h11v11H9z M5 15H4V4h11v1",
  grip: "M9 6v.1 M15 6v.1 M9 12v.1 M15 12v.1 M9 18v.1 M15 18v.1",
  more: "M4 12a1 1 0 1 0 2 0 1 1 0 0 0-2 0z M11 12a1 1 0 1 0 2 0 1 1 0 0 0-2 0z M18 12a1 1 0 1 0 2 0 1 1 0 0 0-2 0z",
  close: "M6 6l12 12 M18 6L6 18",
};

/** @param {string} name @returns {SVGSVGElement} */
export function icon(name) {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("icon");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", paths[name]);
  svg.append(path);
  return svg;
}
