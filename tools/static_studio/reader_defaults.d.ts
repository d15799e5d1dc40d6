/** The constants of normalgan.inference.cleaning.reader by their names, which the build of the site writes. */
export const DOUBT: number;
export const FLAT: number;
export const GREY: [number, number, number];
export const NEARER: [number, number];
export const ONE_TONE: number;
export const PAPER: number;
export const SIDES: [number, number];
export const STRIDE: number;
export const WINDOW: number;
