"use strict";

// Plays a recorded motion: what is shown at any time is what was computed, forwards, backwards and through
// collisions.  The files of this folder are joined into one script, in the order recording, stage, graphs, controls.

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
const WIND = [2, 4, 8, 16]; // times the speed, each time the winding key is pressed
const FIELDS = 6; // of a sample of a body: x, y, angle, vx, vy, angular velocity

class Recording {
  constructor(data) {
    Object.assign(this, data);
    this.motion = floats(data.motion);
    this.duration = (this.count - 1) / this.fps;
  }

  /** x, y, angle, vx, vy, angular velocity of a body at a time between the samples. */
  at(body, time) {
    const place = Math.min(Math.max(time * this.fps, 0), this.count - 1);
    const k = Math.min(Math.floor(place), Math.max(this.count - 2, 0));
    const share = this.count > 1 ? place - k : 0;
    const a = (k * this.bodies.length + body) * FIELDS;
    const b = this.count > 1 ? a + this.bodies.length * FIELDS : a;
    return Array.from({ length: FIELDS }, (_, i) => this.motion[a + i] * (1 - share) + this.motion[b + i] * share);
  }

  sample(body, k, field) {
    return this.motion[(k * this.bodies.length + body) * FIELDS + field];
  }

  /** Net force on a body [N]: its mass times the change of its velocity over the samples around. */
  force(body, time) {
    const h = 1 / this.fps;
    const before = this.at(body, time - h);
    const after = this.at(body, time + h);
    const span = Math.min(time + h, this.duration) - Math.max(time - h, 0) || 1;
    const { mass } = this.bodies[body];
    return [(mass * (after[3] - before[3])) / span, (mass * (after[4] - before[4])) / span];
  }

  /** Curves of a quantity of a body: for each its name and its value at sample k. */
  curves(quantity, body) {
    const { mass, moment } = this.bodies[body];
    const [gx, gy] = this.gravity;
    const value = (field) => (k) => this.sample(body, k, field);
    const [x, y, , vx, vy, spin] = [0, 1, 2, 3, 4, 5].map(value);
    const kinetic = (k) => 0.5 * mass * (vx(k) ** 2 + vy(k) ** 2) + 0.5 * moment * spin(k) ** 2;
    const potential = (k) => -mass * (gx * x(k) + gy * y(k));
    return {
      position: [["x", x], ["y", y]],
      velocity: [["vx", vx], ["vy", vy], ["speed", (k) => Math.hypot(vx(k), vy(k))]],
      energy: [["kinetic", kinetic], ["potential", potential], ["sum", (k) => kinetic(k) + potential(k)]],
      momentum: [["px", (k) => mass * vx(k)], ["py", (k) => mass * vy(k)], ["L", (k) => moment * spin(k)]],
    }[quantity];
  }
}

const UNITS = { position: "m", velocity: "m/s", energy: "J", momentum: "N s; L in N m s" };

function floats(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer); // little-endian, as every browser's machine is
}

class Player {
  constructor(recording) {
    this.recording = recording;
    this.time = 0;
    this.speed = 1;
    this.wind = 0; // -1 back, 1 on, 0 neither; `gear` says how fast
    this.gear = 0;
    this.playing = false;
    this.loop = false;
    this.body = recording.body;
    this.vectors = recording.vectors;
    this.trails = recording.trails;
    this.changed = () => {};
  }

  get rate() {
    return this.wind ? this.wind * WIND[this.gear] * this.speed : this.speed;
  }

  advance(seconds) {
    if (!this.playing) return;
    const { duration } = this.recording;
    let time = this.time + seconds * this.rate;
    if (time >= duration || time < 0) {
      if (this.loop && duration > 0) time = ((time % duration) + duration) % duration;
      else this.pause();
    }
    this.seek(time);
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.recording.duration);
    this.changed();
  }

  play() {
    if (this.time >= this.recording.duration) this.time = 0;
    this.wind = 0;
    this.playing = true;
    this.changed();
  }

  pause() {
    this.playing = false;
    this.wind = 0;
    this.changed();
  }

  toggle() {
    if (this.playing && !this.wind) this.pause();
    else this.play();
  }

  step(frames) {
    this.pause();
    this.seek((Math.round(this.time * this.recording.fps) + frames) / this.recording.fps);
  }

  windTo(direction) {
    this.gear = this.playing && this.wind === direction ? Math.min(this.gear + 1, WIND.length - 1) : 0;
    this.wind = direction;
    this.playing = true;
    this.changed();
  }

  changeSpeed(steps) {
    const k = SPEEDS.indexOf(this.speed) + steps;
    this.speed = SPEEDS[Math.min(Math.max(k, 0), SPEEDS.length - 1)];
    this.changed();
  }
}
