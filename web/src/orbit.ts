// Where the camera stands: turned by mouse, finger or keys, nearer by wheel, two fingers or + and −.

export class Orbit {
  azimuth: number;
  elevation: number;
  distance = 1;
  private readonly pointers = new Map<number, [number, number]>();

  constructor(
    element: HTMLElement,
    private readonly changed: () => void,
    private readonly home: [number, number] = [-1.1, 0.45],
  ) {
    [this.azimuth, this.elevation] = home;
    element.addEventListener("pointerdown", (e) => {
      this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
      element.setPointerCapture(e.pointerId);
    });
    element.addEventListener("pointermove", (e) => this.moved(e));
    for (const end of ["pointerup", "pointercancel"] as const) {
      element.addEventListener(end, (e) => this.pointers.delete(e.pointerId));
    }
    // Without the key or the focus the wheel scrolls the page, as a reader expects.
    const wheel = (e: WheelEvent): void => {
      if (!e.ctrlKey && document.activeElement !== element) return;
      e.preventDefault();
      this.nearer(Math.exp(-0.0015 * e.deltaY));
    };
    element.addEventListener("wheel", wheel, { passive: false });
  }

  turn(right: number, up: number): void {
    this.azimuth += right;
    this.elevation = Math.min(Math.max(this.elevation + up, -1.5), 1.5);
    this.changed();
  }

  nearer(factor: number): void {
    this.distance = Math.min(Math.max(this.distance / factor, 0.15), 5);
    this.changed();
  }

  reset(): void {
    [this.azimuth, this.elevation] = this.home;
    this.distance = 1;
    this.changed();
  }

  /** Acts of keys by their names. */
  readonly keys: Readonly<Record<string, () => void>> = {
    ArrowLeft: () => this.turn(-0.1, 0),
    ArrowRight: () => this.turn(0.1, 0),
    ArrowUp: () => this.turn(0, 0.1),
    ArrowDown: () => this.turn(0, -0.1),
    "+": () => this.nearer(1.15),
    "-": () => this.nearer(1 / 1.15),
  };

  /** Direction from what is looked at to the camera. */
  get direction(): [number, number, number] {
    const c = Math.cos(this.elevation);
    return [c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }

  private moved(e: PointerEvent): void {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const spread = this.spread();
    this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
    if (this.pointers.size === 2) {
      if (spread > 0) this.nearer(this.spread() / spread);
    } else {
      this.turn(-0.008 * (e.clientX - before[0]), 0.008 * (e.clientY - before[1]));
    }
  }

  private spread(): number {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  }
}
