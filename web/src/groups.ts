// The outer faces of a mesh, and the groups of its nodes that a scenario may name.

/** A group of a mesh: how many nodes it holds, and which vertices of the skin. */
export interface Group {
  name: string;
  nodes: number;
  vertices: number[];
}

/** Outer faces of a mesh, in the unit of its file: places of vertices, x, y and z, and corners of triangles. */
export interface Skin {
  vertices: number[];
  triangles: number[];
  groups: Group[];
}

/** Lengths of the edges of the box around vertices. */
export function extent(vertices: number[]): number[] {
  return [0, 1, 2].map((axis) => {
    let [low, high] = [Infinity, -Infinity];
    for (let k = axis; k < vertices.length; k += 3) [low, high] = [Math.min(low, vertices[k]!), Math.max(high, vertices[k]!)];
    return high - low;
  });
}

/** The smallest of the groups that hold a vertex: whoever points at a hole means its edge, not the whole body. */
export function groupAt(groups: Group[], vertex: number): string {
  const holding = groups.filter((each) => each.vertices.includes(vertex));
  return holding.sort((a, b) => a.nodes - b.nodes)[0]?.name ?? "";
}
