/** Smooths the rim of a mesh, which is a staircase of pixels with uneven heights. */

const ROUNDS = 4; // more would erode thin legs and ears

/**
 * Returns edges that only one triangle has, as pairs of vertices. All vertices lie on a grid and are joined to
 * grid neighbours, so that an edge is a vertex and one of nine directions.
 * @param {Uint32Array} corners @param {number} vertices @param {number} columns
 */
function rimOf(corners, vertices, columns) {
  const seen = new Uint8Array(9 * vertices);
  /** @param {number} from @param {number} to */
  const key = (from, to) => {
    const step = to - from + columns + 1; // 0, 1, 2 in the row above; each further row adds the number of columns
    return 9 * from + 3 * Math.floor(step / columns) + (step % columns);
  };
  /** @type {number[]} */
  const rim = [];
  /** @param {(from: number, to: number) => void} act */
  const eachEdge = (act) => {
    for (let at = 0; at < corners.length; at += 3) {
      for (let k = 0; k < 3; k++) act(corners[at + k], corners[at + ((k + 1) % 3)]);
    }
  };
  eachEdge((from, to) => (seen[key(from, to)] = 1));
  eachEdge((from, to) => {
    if (!seen[key(to, from)]) rim.push(from, to);
  });
  return rim;
}

/**
 * Takes each vertex of the rim half-way to the middle of its neighbours on the rim, several times; in place.
 * @param {Float32Array} places three numbers a vertex
 * @param {Uint32Array} corners three vertices a triangle
 * @param {number} columns vertices in a row of the grid
 */
export function smoothRim(places, corners, columns) {
  if (columns < 3) return; // too narrow to have an interior
  const vertices = places.length / 3;
  const rim = rimOf(corners, vertices, columns);
  const sums = new Float32Array(places.length);
  const counts = new Uint8Array(vertices);
  for (let i = 0; i < rim.length; i++) counts[rim[i]]++;
  for (let round = 0; round < ROUNDS; round++) {
    for (const vertex of rim) sums.fill(0, 3 * vertex, 3 * vertex + 3);
    for (let i = 0; i < rim.length; i++) {
      const [vertex, other] = [3 * rim[i], 3 * rim[i ^ 1]];
      for (let k = 0; k < 3; k++) sums[vertex + k] += places[other + k];
    }
    for (let i = 0; i < rim.length; i += 2) {
      const vertex = rim[i]; // each rim vertex starts as many edges as it ends
      for (let k = 3 * vertex; k < 3 * vertex + 3; k++) {
        if (counts[vertex] === 2) places[k] += (sums[k] / 2 - places[k]) / 2;
      }
    }
  }
}
