/** The constants of normalgan.inference.edits by their names, which the build of the site writes. */
export const AVERAGED: number;
export const BRUSH_FADES: number;
export const FADES: number;
export const INKED: number;
export const LEAST_REACH: number;
export const REACH: number;
export const SOFT: number;
