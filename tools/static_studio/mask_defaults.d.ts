/** The constants of normalgan.inference.mask.decision by their names, which the build of the site writes. */
export const INKED: number;
export const OPEN: number;
export const REACH: number;
export const SIDE: number;
export const UNSURE: [number, number, number];
