/** Limits of a drawing, which the server hands to the page; see normalgan.studio.drawings.limits. */

/**
 * @type {{sides: {least: number, most: number}, layers: number, name: number, strokes: number, hints: number, areas: number,
 *   maskStrokes: number, points: number, pictures: number, structures: number, tile: number, periods: {least: number, most: number}, leastZ: number, reach: number,
 *   forms: Record<import("./document.js").Form["kind"], number>, kinds: string[]}} sides: of a drawing, in pixels; name: characters of a layer's; points: of an
 *   area; structures: pictures that are structures, and tile: their side in pixels; periods: sides of a structure's tiles on the drawing; leastZ: below it a normal looks away from the
 *   viewer; reach: of a point that has none of its own, as a share of the longer side; forms: of a part, each with its bevel at first; kinds: of structures that are built in
 */
export const LIMITS = JSON.parse(document.documentElement.dataset.limits ?? "");
