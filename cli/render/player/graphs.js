const CURVES = ["#4477aa", "#ee6677", "#228833"];

class Graph {
  constructor(parent, player, quantity) {
    this.player = player;
    this.quantity = quantity;
    this.box = parent.appendChild(document.createElement("div"));
    this.box.className = "graph";
    this.canvas = this.box.appendChild(document.createElement("canvas"));
    this.cursor = this.box.appendChild(document.createElement("div"));
    this.cursor.className = "cursor";
    this.legend = this.box.appendChild(document.createElement("div"));
    this.legend.className = "legend";
    this.box.addEventListener("pointerdown", (e) => {
      this.box.setPointerCapture(e.pointerId);
      this.wind(e);
    });
    this.box.addEventListener("pointermove", (e) => e.buttons && this.wind(e));
  }

  wind(event) {
    const box = this.canvas.getBoundingClientRect();
    this.player.pause();
    this.player.seek(((event.clientX - box.left) / box.width) * this.player.recording.duration);
  }

  /** Draw the curves; needed only when the body or the size changes. */
  draw() {
    const { recording, body } = this.player;
    const dense = window.devicePixelRatio || 1;
    const width = (this.canvas.width = Math.round(this.canvas.clientWidth * dense));
    const height = (this.canvas.height = Math.round(this.canvas.clientHeight * dense));
    this.curves = recording.curves(this.quantity, body);
    const [low, high] = this.range();
    const c = this.canvas.getContext("2d");
    const row = (value) => height * (1 - (0.08 + (0.84 * (value - low)) / (high - low)));
    c.font = `${11 * dense}px system-ui, sans-serif`;
    c.fillStyle = "#6b6e76";
    c.fillText(short(high), 4 * dense, row(high) + 4 * dense);
    c.fillText(short(low), 4 * dense, row(low) + 4 * dense);
    c.lineWidth = dense;
    if (low < 0 && high > 0) stroke(c, "#d8d6cf", [[0, row(0)], [width, row(0)]]);
    c.lineWidth = 1.6 * dense;
    this.curves.forEach(([, value], i) => {
      const points = [];
      for (let k = 0; k < recording.count; k += 1) {
        points.push([(k / Math.max(recording.count - 1, 1)) * width, row(value(k))]);
      }
      stroke(c, CURVES[i], points);
    });
  }

  range() {
    let [low, high] = [Infinity, -Infinity];
    for (const [, value] of this.curves) {
      for (let k = 0; k < this.player.recording.count; k += 1) {
        low = Math.min(low, value(k));
        high = Math.max(high, value(k));
      }
    }
    const margin = Math.max((high - low) * 0.02, 1e-6 * Math.max(Math.abs(high), Math.abs(low)), 1e-6);
    return [low - margin, high + margin];
  }

  /** Move the cursor and write the values at its time. */
  follow() {
    const { recording, time } = this.player;
    const share = recording.duration ? time / recording.duration : 0;
    this.cursor.style.left = `${100 * share}%`;
    const k = Math.min(Math.round(time * recording.fps), recording.count - 1);
    const values = this.curves.map(([name, value], i) => `<b style="color:${CURVES[i]}">${name}</b> ${short(value(k))}`);
    this.legend.innerHTML = `${this.quantity} [${UNITS[this.quantity]}] &nbsp; ${values.join(" &nbsp; ")}`;
  }
}

function stroke(context, color, points) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.strokeStyle = color;
  context.stroke();
}

function short(value) {
  if (value === 0 || (Math.abs(value) >= 0.01 && Math.abs(value) < 1e4)) return value.toFixed(Math.abs(value) < 10 ? 2 : 1);
  return Math.abs(value) < 1e-6 ? "0.00" : value.toExponential(1);
}
