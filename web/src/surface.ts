// The surface of a solid, moved and coloured by a few shapes.

import { BufferAttribute, BufferGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, WireframeGeometry } from "three";
import { shade } from "./colours";
import { interpolate, type Surface, view } from "./data";

/** Sum of shapes (s, n) with their sizes. */
export function summed(shapes: Float32Array, sizes: ArrayLike<number>, out: Float32Array): Float32Array {
  out.fill(0);
  for (let s = 0; s < sizes.length; s++) {
    const size = sizes[s]!;
    for (let k = 0; k < out.length; k++) out[k]! += size * shapes[s * out.length + k]!;
  }
  return out;
}

/** Von Mises stress of xx, yy, zz, yz, xz, xy at a place in a list. */
export function vonMises(stress: ArrayLike<number>, at: number): number {
  const [x, y, z, a, b, c] = [0, 1, 2, 3, 4, 5].map((i) => stress[at + i]!) as [number, number, number, number, number, number];
  return Math.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 3 * (a * a + b * b + c * c));
}

export class SurfaceMesh {
  readonly group = new Group();
  readonly ghost: LineSegments;
  private readonly rest: Float32Array;
  private readonly moved: Float32Array;
  private readonly stress: Float32Array;
  private readonly positions: Float32Array;
  private readonly colours: Float32Array;
  private readonly geometry = new BufferGeometry();

  constructor(
    private readonly surface: Surface,
    private readonly numbers: Float32Array,
  ) {
    this.rest = view(numbers, surface.vertices);
    this.moved = new Float32Array(this.rest.length);
    this.stress = new Float32Array(2 * this.rest.length);
    this.positions = this.rest.slice();
    this.colours = new Float32Array(this.rest.length).fill(0.5);
    this.geometry.setIndex([...view(numbers, surface.triangles)]);
    this.geometry.setAttribute("position", new BufferAttribute(this.rest.slice(), 3));
    this.ghost = new LineSegments(
      new WireframeGeometry(this.geometry),
      new LineBasicMaterial({ color: 0x888888, transparent: true, opacity: 0.25 }),
    );
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("color", new BufferAttribute(this.colours, 3));
    const material = new MeshStandardMaterial({ vertexColors: true, flatShading: true, side: DoubleSide, roughness: 0.7 });
    this.group.add(new Mesh(this.geometry, material), this.ghost);
  }

  /** The surface at a place among the times, its displacement times a factor; coloured by shares of a largest value. */
  update(place: [number, number], factor: number, by: "stress" | "deflection" | "none", largest: number, grey: number): void {
    const { surface, numbers } = this;
    const count = surface.sizes.shape[1]!;
    const sizes = interpolate(view(numbers, surface.sizes), count, place, new Float32Array(count));
    summed(view(numbers, surface.shapes), sizes, this.moved);
    if (by === "stress") summed(view(numbers, surface.stress), sizes, this.stress);
    for (let v = 0; v < this.rest.length / 3; v++) {
      const size = Math.hypot(this.moved[3 * v]!, this.moved[3 * v + 1]!, this.moved[3 * v + 2]!);
      const share = (by === "stress" ? vonMises(this.stress, 6 * v) : size) / (largest || 1);
      const colour = by === "none" ? ([grey, grey, grey] as const) : shade(share);
      for (let i = 0; i < 3; i++) {
        this.positions[3 * v + i] = this.rest[3 * v + i]! + factor * this.moved[3 * v + i]!;
        this.colours[3 * v + i] = colour[i]! ** 2.2; // the renderer's colours are linear
      }
    }
    this.geometry.getAttribute("position").needsUpdate = true;
    this.geometry.getAttribute("color").needsUpdate = true;
    this.geometry.computeBoundingSphere();
  }
}
