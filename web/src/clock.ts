// One clock for everything that is shown: views, plots and controls read and set it.

export class Clock {
  playing = false;
  speed = 1;
  private now: number;
  private last: number | null = null;
  private readonly listeners = new Set<() => void>();

  constructor(
    readonly start: number,
    readonly end: number,
    at: number = start,
  ) {
    this.now = Math.min(Math.max(at, start), end);
  }

  get time(): number {
    return this.now;
  }

  /** Go to a time, within the range. */
  seek(time: number): void {
    if (!Number.isFinite(time)) return;
    this.now = Math.min(Math.max(time, this.start), this.end);
    this.changed();
  }

  /** Play from where it is; from the start where it is at the end. */
  play(): void {
    if (this.now >= this.end) this.now = this.start;
    this.playing = true;
    this.last = null;
    this.changed();
  }

  pause(): void {
    this.playing = false;
    this.changed();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  /** Advance to a frame drawn at `milliseconds`; a long pause, as of a hidden page, is no time. */
  frame(milliseconds: number): void {
    if (!this.playing) return;
    const passed = this.last === null ? 0 : Math.min(milliseconds - this.last, 250) / 1000;
    this.last = milliseconds;
    this.now += passed * this.speed;
    if (this.now >= this.end) {
      this.now = this.end;
      this.playing = false;
    }
    this.changed();
  }

  /** Call when anything changes; returns what stops that. */
  onChange(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  private changed(): void {
    for (const listener of this.listeners) listener();
  }
}
