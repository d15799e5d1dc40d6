/** The constants of Python's modules that the page's scripts apply as these do, by their names there; the build of the site writes them. */

type Named<Names extends string> = { readonly [name in Names]: number };

export const DECISION: Named<"LEAST_OFF" | "OFF" | "OPEN" | "REACH" | "SIDE" | "UNSURE_HIGH" | "UNSURE_LOW" | "UNSURE_SHARE">;
export const EDGE: Named<"FINER" | "LARGE" | "MERGED" | "PALEST" | "TIP" | "TOUCHING">;
export const EDITS: Named<"AVERAGED" | "BRUSH_FADES" | "FADES" | "LEAST_REACH" | "REACH" | "SOFT">;
export const DRAWINGS: Named<"SMALLEST">;
export const EXTENSION: Named<"SWEEPS">;
export const FIGURES: Named<"ALIKE" | "LEAST" | "OWN_MIDDLE" | "ROOM">;
export const FORMS: Named<"COARSE" | "DISH" | "OUTSIDE" | "SIDE" | "SWEEPS">;
export const INK: Named<"LEAST">;
export const ISLANDS: Named<"BESIDE" | "FAINT" | "SMALL">;
export const LINE_WIDTH: Named<"DRAWN_WIDTH" | "FINER" | "ROUGH" | "THIN" | "THINNEST">;
export const NORMAL_MAP: Named<"PADDING">;
export const PIPELINE: Named<"BESIDE" | "LEAST" | "PRESENT">;
export const READER: Named<"DOUBT" | "FLAT" | "NARROWEST" | "ONE_TONE" | "PAPER" | "STRIDE" | "WINDOW"> & {
  readonly GREY: [number, number, number]; readonly NEARER: [number, number]; readonly SIDES: [number, number];
};
export const REGIONS: Named<"INKED">;
export const SHEETS: Named<"MOST_CELLS">;
export const SILHOUETTE: Named<"HELD" | "RIM" | "SHEET" | "SURE" | "TINY" | "TRANSLUCENT">;
export const SUGGESTION: Named<"INKED" | "RIM" | "SIDE">;
export const UNROLLING: Named<"GROUND" | "LEAST" | "SIDE" | "SLACK">;
export const UPSAMPLING: Named<"CELL" | "ENLARGED" | "LARGEST" | "RIM">;
