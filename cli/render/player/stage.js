const LINE = 2; // width of outlines in a picture 1280 pixels wide

class Stage {
  constructor(canvas, player) {
    this.canvas = canvas;
    this.player = player;
    this.recording = player.recording;
    this.context = canvas.getContext("2d");
  }

  resize() {
    const [width, height] = this.recording.size;
    const shown = this.canvas.clientWidth || width;
    const dense = window.devicePixelRatio || 1;
    this.canvas.style.height = `${(shown * height) / width}px`;
    this.canvas.width = Math.round(shown * dense);
    this.canvas.height = Math.round((shown * height * dense) / width);
    this.zoom = this.canvas.width / width;
    this.pixel = 1 / (this.recording.scale * this.zoom); // a canvas pixel [m]
    this.unit = this.pixel * dense * Math.max(shown / 1280, 0.6); // a pixel of a picture 1280 wide [m]
  }

  draw() {
    const { context: c, recording, player } = this;
    const scale = recording.scale * this.zoom;
    const [left, top] = this.corner();
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.fillStyle = recording.paper;
    c.fillRect(0, 0, this.canvas.width, this.canvas.height);
    c.setTransform(scale, 0, 0, -scale, -left * scale, top * scale);
    c.lineJoin = c.lineCap = "round";
    if (recording.grid) this.drawGrid();
    if (!recording.movesInk) this.drawInk();
    recording.bodies.forEach((body, k) => body.anchored && this.drawBody(body, recording.at(k, 0), k));
    if (!recording.movesInk) recording.pivots.forEach((pivot) => pivot.ground && this.drawSupport(pivot));
    if (player.trails) this.drawTrails();
    recording.bodies.forEach((body, k) => body.anchored || this.drawBody(body, recording.at(k, player.time), k));
    if (recording.movesInk) this.drawInk();
    else recording.pivots.forEach((pivot) => this.drawPivot(pivot));
    if (player.vectors) this.drawVectors();
    this.drawScale();
    this.drawGravity();
  }

  /** The world point in the upper left corner [m]: it goes with the body that is followed. */
  corner() {
    const { corner, follow, size: [width, height], scale } = this.recording;
    if (follow < 0) return corner;
    const [x, y] = this.recording.at(follow, this.player.time);
    return [x - width / (2 * scale), y + height / (2 * scale)];
  }

  drawGrid() {
    const { grid: { step, color }, size: [width, height], scale } = this.recording;
    const [left, top] = this.corner();
    const [right, bottom] = [left + width / scale, top - height / scale];
    const c = this.context;
    c.beginPath();
    for (let x = Math.ceil(left / step) * step; x < right; x += step) this.path([[x, bottom], [x, top]]);
    for (let y = Math.ceil(bottom / step) * step; y < top; y += step) this.path([[left, y], [right, y]]);
    c.strokeStyle = color;
    c.lineWidth = this.unit;
    c.stroke();
  }

  /** The person's strokes; in the style that moves them each goes with its body. */
  drawInk() {
    const c = this.context;
    c.strokeStyle = this.recording.drawn;
    c.lineWidth = this.unit * (this.recording.movesInk ? 1.6 : 1);
    for (const stroke of this.recording.ink) {
      c.save();
      if (stroke.body >= 0) {
        const [x, y, angle] = this.recording.at(stroke.body, this.player.time);
        c.translate(x, y);
        c.rotate(angle);
      }
      c.beginPath();
      this.path(stroke.points);
      c.stroke();
      c.restore();
    }
  }

  path(points) {
    points.forEach(([x, y], k) => (k ? this.context.lineTo(x, y) : this.context.moveTo(x, y)));
  }

  shape(body) {
    const c = this.context;
    c.beginPath();
    if (body.radius) c.arc(0, 0, body.radius, 0, 2 * Math.PI);
    else this.path(body.outline);
    c.closePath();
  }

  drawBody(body, [x, y, angle], k) {
    const c = this.context;
    c.save();
    c.translate(x, y);
    c.rotate(angle);
    this.shape(body);
    c.fillStyle = body.fill;
    c.fill();
    if (body.anchored && !this.recording.movesInk) this.hatch(body);
    if (body.radius && !body.anchored) {
      c.moveTo(0, 0);
      c.lineTo(body.radius, 0);
    }
    c.strokeStyle = body.edge;
    const chosen = k === this.player.body;
    c.lineWidth = LINE * this.unit * (chosen ? 1.8 : 1);
    if (!this.recording.movesInk || chosen) c.stroke();
    c.restore();
  }

  /** Stripes at 45 degrees to the page, whichever way the body lies. */
  hatch(body) {
    const c = this.context;
    const reach = body.radius || Math.max(...body.outline.map(([x, y]) => Math.hypot(x, y)));
    c.save();
    c.clip();
    c.rotate(Math.PI / 4 - body.angle);
    c.beginPath();
    for (let s = -reach; s < reach; s += 11 * this.unit) {
      c.moveTo(-reach, s);
      c.lineTo(reach, s);
    }
    c.strokeStyle = body.stripes;
    c.lineWidth = 1.4 * this.unit;
    c.stroke();
    c.restore();
    this.shape(body);
  }

  pivotAt(pivot) {
    if (pivot.body < 0) return pivot.at;
    const [x, y, angle] = this.recording.at(pivot.body, this.player.time);
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [x + c * pivot.at[0] - s * pivot.at[1], y + s * pivot.at[0] + c * pivot.at[1]];
  }

  drawPivot(pivot) {
    const [x, y] = this.pivotAt(pivot);
    const c = this.context;
    for (const [radius, color] of [[7.5, this.recording.dark], [5.3, this.recording.paper], [2.4, this.recording.dark]]) {
      c.beginPath();
      c.arc(x, y, radius * this.unit, 0, 2 * Math.PI);
      c.fillStyle = color;
      c.fill();
    }
  }

  drawSupport(pivot) {
    const c = this.context;
    const [x, y] = pivot.world;
    const u = this.unit;
    c.beginPath();
    this.path([[x, y], [x + 15 * u, y - 24 * u], [x - 15 * u, y - 24 * u]]);
    c.closePath();
    for (let k = -22; k <= 22; k += 7) {
      c.moveTo(x + k * u, y - 24 * u);
      c.lineTo(x + (k - 6) * u, y - 32 * u);
    }
    c.moveTo(x - 23 * u, y - 24 * u);
    c.lineTo(x + 23 * u, y - 24 * u);
    c.strokeStyle = this.recording.dark;
    c.lineWidth = LINE * u;
    c.stroke();
  }

  drawTrails() {
    const c = this.context;
    const last = Math.floor(this.player.time * this.recording.fps);
    this.recording.bodies.forEach((body, k) => {
      if (body.anchored) return;
      c.beginPath();
      for (let i = 0; i <= last; i += 1) {
        const [x, y] = [this.recording.sample(k, i, 0), this.recording.sample(k, i, 1)];
        if (i) c.lineTo(x, y);
        else c.moveTo(x, y);
      }
      c.strokeStyle = body.color;
      c.lineWidth = 1.6 * this.unit;
      c.stroke();
    });
  }

  drawVectors() {
    const { recording, player } = this;
    recording.bodies.forEach((body, k) => {
      if (body.anchored) return;
      const [x, y, , vx, vy] = recording.at(k, player.time);
      this.arrow(x, y, vx, vy, 60 * this.unit, this.recording.velocityPaint); // at most so long
      const [fx, fy] = recording.force(k, player.time);
      const weight = body.mass * (Math.hypot(...recording.gravity) || 1);
      this.arrow(x, y, fx / weight, fy / weight, 45 * this.unit, this.recording.forcePaint);
    });
  }

  /** An arrow along (dx, dy); its length grows ever slower and stays below twice `size`. */
  arrow(x, y, dx, dy, size, color) {
    const amount = Math.hypot(dx, dy);
    if (amount < 1e-3) return;
    const length = (2 * size * amount) / (1 + amount);
    const [ux, uy] = [dx / amount, dy / amount];
    const [ex, ey] = [x + ux * length, y + uy * length];
    const head = Math.min(9 * this.unit, length / 2);
    const c = this.context;
    c.beginPath();
    this.path([[x, y], [ex, ey]]);
    this.path([[ex - head * (ux + 0.5 * uy), ey - head * (uy - 0.5 * ux)], [ex, ey],
      [ex - head * (ux - 0.5 * uy), ey - head * (uy + 0.5 * ux)]]);
    c.strokeStyle = color;
    c.lineWidth = 2.4 * this.unit;
    c.stroke();
  }

  drawScale() {
    const c = this.context;
    const { scale, bar } = this.recording;
    const [left, top] = this.corner();
    const u = this.unit;
    const [x, y] = [left + bar.at[0] / scale, top - bar.at[1] / scale];
    c.beginPath();
    this.path([[x, y + 5 * u], [x, y - 5 * u]]);
    this.path([[x, y], [x + bar.metres, y]]);
    this.path([[x + bar.metres, y + 5 * u], [x + bar.metres, y - 5 * u]]);
    c.strokeStyle = this.recording.dark;
    c.lineWidth = LINE * u;
    c.stroke();
    this.text(bar.label, x, y + 12 * u, 16);
  }

  drawGravity() {
    const { size: [width], scale, gravity } = this.recording;
    const [left, top] = this.corner();
    const u = this.unit;
    const size = Math.hypot(...gravity);
    const x = left + width / scale - 48 * u;
    if (!size) return this.text("no gravity", x - 50 * u, top - 34 * u, 16);
    const [gx, gy] = [gravity[0] / size, gravity[1] / size];
    const c = this.context;
    const y = top - 52 * u;
    const [ex, ey] = [x + gx * 26 * u, y + gy * 26 * u];
    c.beginPath();
    this.path([[x - gx * 26 * u, y - gy * 26 * u], [ex, ey]]);
    this.path([[ex - 12 * u * (gx + 0.5 * gy), ey - 12 * u * (gy - 0.5 * gx)], [ex, ey],
      [ex - 12 * u * (gx - 0.5 * gy), ey - 12 * u * (gy + 0.5 * gx)]]);
    c.strokeStyle = this.recording.dark;
    c.lineWidth = 2.6 * u;
    c.stroke();
    return this.text("g", x - 26 * u, y - 4 * u, 16);
  }

  text(text, x, y, height) {
    const c = this.context;
    c.save();
    c.translate(x, y);
    c.scale(this.unit, -this.unit);
    c.fillStyle = this.recording.dark;
    c.font = `${height}px system-ui, sans-serif`;
    c.strokeStyle = this.recording.paper;
    c.lineWidth = 4;
    c.strokeText(text, 0, 0);
    c.fillText(text, 0, 0);
    c.restore();
  }

  /** The topmost body under a point of the window, or -1. */
  bodyAt(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const scale = (this.recording.scale * box.width) / this.recording.size[0];
    const [left, top] = this.corner();
    const x = left + (clientX - box.left) / scale;
    const y = top - (clientY - box.top) / scale;
    const c = this.context;
    for (let k = this.recording.bodies.length - 1; k >= 0; k -= 1) {
      const [bx, by, angle] = this.recording.at(k, this.player.time);
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      const [dx, dy] = [x - bx, y - by];
      c.save();
      c.setTransform(1, 0, 0, 1, 0, 0);
      this.shape(this.recording.bodies[k]);
      const hit = c.isPointInPath(cos * dx + sin * dy, cos * dy - sin * dx);
      c.restore();
      if (hit) return k;
    }
    return -1;
  }
}
