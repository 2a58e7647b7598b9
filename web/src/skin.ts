// The outer faces of a mesh: turned by mouse, finger or keys; a click names the group that lies there.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshStandardMaterial,
  PerspectiveCamera,
  Points,
  PointsMaterial,
  Raycaster,
  Scene,
  Vector2,
  Vector3,
  WebGLRenderer,
  WireframeGeometry,
} from "three";
import { lineColour, prefersDark } from "./colours";
import { element } from "./controls";
import { extent, groupAt, type Skin } from "./groups";
import { Orbit } from "./orbit";

const STILL = 4; // pixels that the mouse may move within a click

export class SkinView {
  private readonly label = element("div", "gbeam-label");
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 0.001, 1e4);
  private readonly orbit: Orbit;
  private readonly geometry = new BufferGeometry();
  private readonly faces: Mesh;
  private readonly dots: Points;
  private readonly middle: Vector3;
  private readonly radius: number;
  private readonly resized = new ResizeObserver(() => this.draw());
  private readonly scheme = window.matchMedia("(prefers-color-scheme: dark)");
  private clamp: ReadonlySet<string> = new Set();

  private constructor(
    private readonly stage: HTMLElement,
    private readonly skin: Skin,
    private readonly renderer: WebGLRenderer,
    private readonly canvas: HTMLCanvasElement,
    picked: (group: string) => void,
  ) {
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "The mesh. Arrow keys turn it; the list below chooses the same groups as a click.");
    // Every face has corners of its own, and so its own colour.
    const corners = new Float32Array(3 * skin.triangles.length);
    skin.triangles.forEach((vertex, k) => corners.set(skin.vertices.slice(3 * vertex, 3 * vertex + 3), 3 * k));
    this.geometry.setAttribute("position", new BufferAttribute(corners, 3));
    this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(corners.length), 3));
    this.geometry.computeBoundingBox();
    this.middle = this.geometry.boundingBox!.getCenter(new Vector3());
    this.radius = Math.hypot(...extent(skin.vertices)) / 2 || 1;
    this.faces = new Mesh(
      this.geometry,
      new MeshStandardMaterial({ vertexColors: true, flatShading: true, side: DoubleSide, roughness: 0.8, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
    );
    const edges = new LineBasicMaterial({ color: 0x888888, transparent: true, opacity: 0.35 });
    this.dots = new Points(new BufferGeometry(), new PointsMaterial({ size: 5, sizeAttenuation: false }));
    const sun = new DirectionalLight(0xffffff, 2.6);
    sun.position.set(2, -3, 5);
    this.scene.add(new AmbientLight(0xffffff, 1.5), sun, this.faces, new LineSegments(new WireframeGeometry(this.geometry), edges), this.dots);
    this.camera.up.set(0, 0, 1);
    this.orbit = new Orbit(canvas, () => this.draw());
    this.listen(picked);
    this.resized.observe(stage);
    this.scheme.addEventListener("change", this.recolour);
  }

  /** A view inside an element; words there instead, and null, where there is no WebGL. */
  static mount(stage: HTMLElement, skin: Skin, picked: (group: string) => void): SkinView | null {
    const canvas = element("canvas", "gbeam-canvas");
    let renderer: WebGLRenderer;
    try {
      renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    } catch {
      stage.append(element("p", "faint", "This browser shows no WebGL: choose the groups in the list."));
      return null;
    }
    const view = new SkinView(stage, skin, renderer, canvas, picked);
    stage.append(canvas, view.label);
    return view;
  }

  /** Show which groups are clamped. */
  show(clamp: ReadonlySet<string>): void {
    this.clamp = clamp;
    this.recolour();
  }

  dispose(): void {
    this.resized.disconnect();
    this.scheme.removeEventListener("change", this.recolour);
    this.renderer.dispose();
  }

  private readonly recolour = (): void => {
    const { skin } = this;
    const held = new Set(skin.groups.filter((each) => this.clamp.has(each.name)).flatMap((each) => each.vertices));
    const dark = prefersDark();
    const [plain, chosen] = [new Color(dark ? 0x9aa3ad : 0xb8bec6), new Color(lineColour(1, dark))];
    const colours = this.geometry.getAttribute("color");
    for (let k = 0; k < skin.triangles.length; k += 3) {
      const all = [0, 1, 2].every((i) => held.has(skin.triangles[k + i]!));
      for (let i = 0; i < 3; i++) (all ? chosen : plain).toArray(colours.array, 3 * (k + i));
    }
    colours.needsUpdate = true;
    const places = new Float32Array([...held].flatMap((vertex) => skin.vertices.slice(3 * vertex, 3 * vertex + 3)));
    this.dots.geometry.setAttribute("position", new BufferAttribute(places, 3));
    (this.dots.material as PointsMaterial).color = chosen;
    this.scene.background = new Color(dark ? 0x14171c : 0xf4f5f7);
    this.draw();
  };

  private listen(picked: (group: string) => void): void {
    let down: [number, number] | null = null;
    this.canvas.addEventListener("pointerdown", (e) => (down = [e.clientX, e.clientY]));
    this.canvas.addEventListener("pointerup", (e) => {
      if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > STILL) return;
      const group = this.at(e);
      if (group) picked(group);
    });
    this.canvas.addEventListener("pointermove", (e) => {
      this.label.textContent = e.buttons ? "" : this.at(e);
    });
    this.canvas.addEventListener("pointerleave", () => (this.label.textContent = ""));
    this.canvas.addEventListener("keydown", (e) => {
      const act = e.key === "Home" ? () => this.orbit.reset() : this.orbit.keys[e.key];
      if (!act) return;
      e.preventDefault();
      act();
    });
  }

  /** The group under the mouse, that of the corner nearest to it. */
  private at(e: PointerEvent): string {
    const box = this.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    const place = new Vector2((2 * (e.clientX - box.left)) / box.width - 1, 1 - (2 * (e.clientY - box.top)) / box.height);
    ray.setFromCamera(place, this.camera);
    const hit = ray.intersectObject(this.faces)[0];
    if (!hit) return "";
    const corners = [0, 1, 2].map((i) => this.skin.triangles[3 * hit.faceIndex! + i]!);
    const far = (vertex: number): number => hit.point.distanceTo(new Vector3().fromArray(this.skin.vertices, 3 * vertex));
    return groupAt(this.skin.groups, corners.sort((a, b) => far(a) - far(b))[0]!);
  }

  private draw(): void {
    const width = this.stage.clientWidth;
    if (!width) return;
    const height = Math.round(Math.min(Math.max(0.6 * width, 200), 380));
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const away = (1.05 * this.radius * this.orbit.distance) / (half * Math.min(1, width / height));
    this.camera.aspect = width / height;
    this.camera.near = away / 100;
    this.camera.far = away * 10;
    this.camera.position.fromArray(this.orbit.direction).multiplyScalar(away).add(this.middle);
    this.camera.lookAt(this.middle);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
  }
}
