// One view of one motion: its bodies in base axes, or on the machine that carries them.

import {
  AmbientLight,
  ArrowHelper,
  Color,
  CylinderGeometry,
  DirectionalLight,
  type Material,
  Mesh,
  PerspectiveCamera,
  Scene,
  Vector3,
  type WebGLRenderer,
} from "three";
import { Body, type Settings } from "./bodies";
import { axesOnly, type Carrier, centrifuge, flying, hub, plainArm, surroundings } from "./carriers";
import { interpolate, locate, type Motion, view } from "./data";
import { lineColour } from "./colours";
import type { Orbit } from "./orbit";

export class Panel {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(32, 1, 0.001, 1e4);
  private readonly bodies: Body[];
  private readonly arrows: { made: ArrowHelper; wanted: ArrowHelper | null } | null = null;
  private readonly carrier: Carrier;
  private readonly length: number;
  private middle: [number, number, number];
  private deflection = 0; // the largest as it is drawn

  constructor(
    readonly motion: Motion,
    private readonly numbers: Float32Array,
    readonly whole: boolean,
  ) {
    this.length = motion.length;
    this.carrier = this.carrying();
    this.middle = [...this.carrier.middle];
    this.bodies = motion.parts.map((part) => new Body(part, numbers, this.carrier.size));
    for (const each of this.bodies) this.carrier.base.add(each.group);
    if (motion.load) {
      const at = new Vector3(...(motion.controlPlace ?? []));
      const made = arrow(at, this.length);
      // A thick shaft, so that the thin arrow of the target is seen inside where the two agree.
      const shaft = new CylinderGeometry(0.006 * this.length, 0.006 * this.length, 0.9, 12).translate(0, 0.45, 0);
      const thick = new Mesh(shaft, made.cone.material);
      made.line.add(thick);
      const wanted = motion.reference ? arrow(at, this.length) : null;
      // Seen through a solid that is in front.
      for (const part of [made.line, made.cone, thick, ...(wanted ? [wanted.line, wanted.cone] : [])]) {
        (part.material as Material).depthTest = false;
        part.renderOrder = part === wanted?.line || part === wanted?.cone ? 2 : 1;
      }
      this.arrows = { made, wanted };
      this.carrier.base.add(made);
      if (wanted) this.carrier.base.add(wanted);
    }
    const key = new DirectionalLight(0xffffff, 2.6);
    key.position.set(2, -3, 5);
    this.scene.add(new AmbientLight(0xffffff, 1.5), key, this.carrier.world);
    this.camera.up.set(0, 0, 1);
  }

  get title(): string {
    const of = this.motion.name === this.motion.environment ? "" : ` (${this.motion.environment})`;
    if (this.motion.middle && !this.whole) return `${this.motion.name}${of}`;
    if (!this.whole) return `${this.motion.name}${of}, base axes`;
    const whole = { hub: "hub", arm: "arm", flight: "turning" }[this.motion.environment] ?? "machine";
    return `${this.motion.name}${of}, ${whole}`;
  }

  get note(): string {
    return this.carrier.note;
  }

  /** What there is at a time, in words: before, during or after the flight. */
  state(t: number): string {
    if (this.motion.period) return "";
    const times = view(this.numbers, this.motion.time);
    const slack = 1e-6 * Math.max(1, Math.abs(t));
    if (t < times[0]! - slack) return "not begun";
    if (t > times[times.length - 1]! + slack) return "over";
    const span = this.motion.span;
    if (span && t < span[0]) return "spin-up";
    if (span && t > span[1]) return "spin-down";
    return "";
  }

  /** Everything as it is at a time, s. */
  update(t: number, settings: Settings, dark: boolean): void {
    const { motion, numbers } = this;
    this.deflection = settings.factor * motion.largest;
    const place = locate(view(numbers, motion.time), motion.period ? t % motion.period : t);
    for (const each of this.bodies) each.update(place, settings, dark);
    if (motion.middle && !this.whole && motion.middle.shape[0]! > 1) {
      this.middle = [...interpolate(view(numbers, motion.middle), 3, place, new Float32Array(3))] as typeof this.middle;
    }
    const angles = motion.axes ?? motion.angle ?? motion.attitude;
    if (this.whole && angles) {
      const width = angles.shape[1] ?? 1;
      this.carrier.turn([...interpolate(view(numbers, angles), width, place, new Float32Array(width))]);
    }
    this.point(settings, place, dark);
    this.scene.background = new Color(dark ? 0x14171c : 0xf4f5f7);
  }

  /** Draw into a part of the canvas: left, bottom, width and height in pixels. */
  draw(renderer: WebGLRenderer, orbit: Orbit, box: [number, number, number, number]): void {
    const [left, bottom, width, height] = box;
    if (width < 2 || height < 2) return;
    const aspect = width / height;
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    // Bent farther than the beam is long, it is seen from farther away.
    const size = Math.max(this.carrier.size, this.whole ? 0 : this.deflection);
    const away = (size / (half * Math.min(1, aspect))) * orbit.distance;
    const [x, y, z] = this.middle;
    const [a, b, c] = orbit.direction;
    this.camera.aspect = aspect;
    this.camera.near = away / 100;
    this.camera.far = away * 10;
    this.camera.position.set(x + away * a, y + away * b, z + away * c);
    this.camera.lookAt(x, y, z);
    this.camera.updateProjectionMatrix();
    renderer.setViewport(left, bottom, width, height);
    renderer.setScissor(left, bottom, width, height);
    renderer.render(this.scene, this.camera);
  }

  private carrying(): Carrier {
    const { motion, length } = this;
    if (this.whole && motion.axes && motion.arm) {
      return centrifuge(motion.arm, motion.extent!, motion.controlPlace!, motion.turn);
    }
    if (this.whole && motion.angle && motion.place) {
      return plainArm(motion.place, length, motion.mounting ?? [1, 0, 0, 0, 1, 0, 0, 0, 1]);
    }
    if (this.whole && motion.angle && motion.radius !== undefined) {
      return hub(motion.radius, length, motion.mounting ?? [1, 0, 0, 0, 1, 0, 0, 0, 1]);
    }
    if (this.whole && motion.attitude) return flying(length);
    if (motion.middle) {
      return surroundings(motion.radiusShown!, [...view(this.numbers, motion.middle).subarray(0, 3)], length);
    }
    const still = motion.environment === "flight" && !motion.attitude;
    return axesOnly(length, still ? "no rates are given: its axes are drawn without turning" : "");
  }

  private point(settings: Settings, place: [number, number], dark: boolean): void {
    if (!this.arrows) return;
    const { motion, numbers } = this;
    const set = (which: ArrowHelper | null, values: typeof motion.load, colour: string): void => {
      if (!which || !values) return;
      const load = new Vector3(...interpolate(view(numbers, values), 3, place, new Float32Array(3)));
      const size = (0.5 * this.length * load.length()) / (settings.largestLoad || 1);
      which.visible = settings.loads && size > 0.004 * this.length;
      if (!which.visible) return;
      which.setDirection(load.normalize());
      which.setLength(size, Math.min(0.05 * this.length, 0.5 * size), 0.025 * this.length);
      which.setColor(colour);
    };
    set(this.arrows.wanted, motion.reference, lineColour(6, dark));
    set(this.arrows.made, motion.load, lineColour(1, dark));
  }
}

function arrow(at: Vector3, length: number): ArrowHelper {
  return new ArrowHelper(new Vector3(0, 0, 1), at, length);
}

