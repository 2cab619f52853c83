"use strict";
// The moving system on a canvas, seen from any side.  No library, no network: the frames stand in the page.
(() => {
  const source = document.getElementById("motion-data");
  const canvas = document.getElementById("motion-canvas");
  if (!source || !canvas) return;
  const data = JSON.parse(source.textContent);
  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const times = floats(data.times);
  const frames = times.length;
  const places = floats(data.places);                       // [point][component][frame]
  const ellipsoids = data.ellipsoids.map((item) => ({ axes: floats(item.axes), place: floats(item.places) }));
  const outlines = (data.outlines || []).map((item) => (
    { axes: floats(item.axes), place: floats(item.places), lines: item.lines }));
  const series = { kinetic: floats(data.kinetic), energy: floats(data.energy), drift: floats(data.drift) };
  const change = series.energy.map((value) => value - series.energy[0]);
  const still = frames < 2;
  const end = times[frames - 1];
  const element = (id) => document.getElementById(id);
  const slider = element("motion-time"), button = element("motion-play"), speed = element("motion-speed");
  const trails = element("motion-trails"), reading = element("motion-reading"), chart = element("motion-energies");
  const reduced = matchMedia("(prefers-reduced-motion: reduce)");
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colours = () => {
    const style = getComputedStyle(document.documentElement);
    const read = (name) => style.getPropertyValue(name).trim();
    return { ink: read("--ink"), soft: read("--soft"), line: read("--line"), paper: read("--paper"),
             accent: read("--accent"), bad: read("--bad") };
  };
  const paths = dark.matches
    ? ["#ff9a90", "#76d39b", "#f0c060", "#c9a4f0", "#6fd3e0", "#d8b48c"]
    : ["#b3372f", "#2e8b57", "#c06a10", "#8e5ea2", "#0f7f93", "#7a5c3e"];
  let now = 0, playing = false, last = null, ink = colours();
  let look = { azimuth: data.azimuth, elevation: data.elevation, zoom: 1 };

  // The eye: rows to the right, upwards and towards it, from level directions about "up".
  const projection = () => {
    const [first, second, up] = data.basis;
    const a = look.azimuth * Math.PI / 180, e = look.elevation * Math.PI / 180;
    const level = [0, 1, 2].map((k) => Math.cos(a) * first[k] + Math.sin(a) * second[k]);
    return [
      [0, 1, 2].map((k) => -Math.sin(a) * first[k] + Math.cos(a) * second[k]),
      [0, 1, 2].map((k) => -Math.sin(e) * level[k] + Math.cos(e) * up[k]),
      [0, 1, 2].map((k) => Math.cos(e) * level[k] + Math.sin(e) * up[k]),
    ];
  };
  const dot = (u, x, y, z) => u[0] * x + u[1] * y + u[2] * z;

  // Between two frames everything is joined by straight lines.
  const between = (values, start, at) => {
    const k = Math.min(Math.floor(at), frames - 1), part = at - k;
    const here = values[start + k];
    return part > 0 && k + 1 < frames ? here + part * (values[start + k + 1] - here) : here;
  };
  const at = (t) => {
    if (still) return 0;
    let low = 0, high = frames - 1;
    while (high - low > 1) { const mid = (low + high) >> 1; if (times[mid] <= t) low = mid; else high = mid; }
    return low + Math.min(1, Math.max(0, (t - times[low]) / (times[high] - times[low])));
  };

  const fit = (target) => {
    const ratio = window.devicePixelRatio || 1, box = target.getBoundingClientRect();
    const wide = Math.max(1, Math.round(box.width * ratio)), tall = Math.max(1, Math.round(box.height * ratio));
    if (target.width !== wide || target.height !== tall) { target.width = wide; target.height = tall; }
    const pen = target.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, box.width, box.height);
    return { pen, wide: box.width, tall: box.height };
  };

  const draw = () => {
    const { pen, wide, tall } = fit(canvas);
    const eye = projection(), place = at(now);
    const scale = look.zoom * 0.86 * Math.min(wide, tall) / data.size;
    const flat = (x, y, z) => [
      wide / 2 + scale * dot(eye[0], x - data.middle[0], y - data.middle[1], z - data.middle[2]),
      tall / 2 - scale * dot(eye[1], x - data.middle[0], y - data.middle[1], z - data.middle[2]),
    ];
    const point = (i, f) => flat(between(places, 3 * i * frames, f), between(places, (3 * i + 1) * frames, f),
                                 between(places, (3 * i + 2) * frames, f));
    pen.lineJoin = pen.lineCap = "round";
    if (trails.checked && !still) {
      data.trails.forEach(([i], number) => {
        pen.strokeStyle = paths[number % paths.length];
        pen.lineWidth = 1;
        pen.beginPath();
        for (let k = 0; k <= Math.floor(place); k += 1) pen.lineTo(...point(i, k));
        pen.lineTo(...point(i, place));
        pen.stroke();
      });
    }
    pen.strokeStyle = ink.soft;
    pen.lineWidth = 1;
    for (const item of ellipsoids) {
      const centre = [0, 1, 2].map((k) => between(item.place, k * frames, place));
      const axes = [0, 1, 2].map((p) => [0, 1, 2].map((k) => between(item.axes, (3 * p + k) * frames, place)));
      for (const [p, q] of [[0, 1], [1, 2], [2, 0]]) {
        pen.beginPath();
        for (let step = 0; step <= 48; step += 1) {
          const c = Math.cos(step * Math.PI / 24), s = Math.sin(step * Math.PI / 24);
          pen.lineTo(...flat(...[0, 1, 2].map((k) => centre[k] + c * axes[p][k] + s * axes[q][k])));
        }
        pen.stroke();
      }
    }
    for (const item of outlines) {
      const centre = [0, 1, 2].map((k) => between(item.place, k * frames, place));
      const axes = [0, 1, 2].map((p) => [0, 1, 2].map((k) => between(item.axes, (3 * p + k) * frames, place)));
      for (const line of item.lines) {
        pen.beginPath();
        for (const own of line) {
          pen.lineTo(...flat(...[0, 1, 2].map(
            (k) => centre[k] + own[0] * axes[0][k] + own[1] * axes[1][k] + own[2] * axes[2][k])));
        }
        pen.stroke();
      }
    }
    pen.strokeStyle = ink.ink;
    for (const [pairs, width, dash] of [[data.slides, 1.2, [6, 4]], [data.links, 2.6, []]]) {
      pen.lineWidth = width;
      pen.setLineDash(dash);
      for (const [i, j] of pairs) {
        pen.beginPath(); pen.moveTo(...point(i, place)); pen.lineTo(...point(j, place)); pen.stroke();
      }
    }
    pen.setLineDash([]);
    for (const [points, radius, fill] of [[data.joints, 3, ink.paper], [data.centres, 4.2, ink.ink]]) {
      pen.fillStyle = fill;
      pen.lineWidth = 1.2;
      for (const i of points) {
        pen.beginPath(); pen.arc(...point(i, place), radius, 0, 2 * Math.PI); pen.fill(); pen.stroke();
      }
    }
    axes(pen, eye, tall);
    read(place);
  };

  const axes = (pen, eye, tall) => {
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (let k = 0; k < 3; k += 1) {
      const x = 46 + 28 * eye[0][k], y = tall - 46 - 28 * eye[1][k];
      if (Math.hypot(eye[0][k], eye[1][k]) < 0.08) continue;   // it points at the eye
      pen.strokeStyle = pen.fillStyle = ink.soft;
      pen.lineWidth = 1.2;
      pen.beginPath(); pen.moveTo(46, tall - 46); pen.lineTo(x, y); pen.stroke();
      pen.fillText(String(k + 1), 46 + 38 * eye[0][k], tall - 46 - 38 * eye[1][k]);
    }
  };

  const number = (value) => Number.isFinite(value) ? String(Number(value.toPrecision(5))) : "\u2013";
  const read = (place) => {
    if (still) return;
    const k = Math.round(place), measure = data.measure ? " " + data.measure : "";
    const shown = `t = ${number(now)}${data.time ? " " + data.time : ""}`;
    reading.textContent = shown;
    slider.setAttribute("aria-valuetext", shown);
    element("motion-kinetic").textContent = number(series.kinetic[k]) + measure;
    element("motion-energy").textContent = number(series.energy[k]) + measure;
    element("motion-drift").textContent = series.drift[k] === 0 ? "0" : series.drift[k].toExponential(1);
    const { pen, wide, tall } = fit(chart);
    let low = Infinity, high = -Infinity;
    for (const row of [series.kinetic, change]) {
      for (const value of row) if (Number.isFinite(value)) { low = Math.min(low, value); high = Math.max(high, value); }
    }
    const size = high - low || 1;
    const x = (t) => 4 + (wide - 8) * t / end, y = (value) => tall - 6 - (tall - 12) * (value - low) / size;
    pen.strokeStyle = ink.line;
    pen.strokeRect(0.5, 0.5, wide - 1, tall - 1);
    for (const [row, colour, dash] of [[series.kinetic, ink.accent, []], [change, ink.bad, [5, 3]]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = 1.4;
      pen.setLineDash(dash);
      pen.beginPath();
      for (let f = 0; f < frames; f += 1) pen.lineTo(x(times[f]), y(row[f]));
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.strokeStyle = ink.ink;
    pen.beginPath(); pen.moveTo(x(now), 2); pen.lineTo(x(now), tall - 2); pen.stroke();
  };

  const go = (t) => { now = Math.min(end, Math.max(0, t)); if (!still) slider.value = String(now / end); draw(); };
  const tick = (stamp) => {
    if (!playing) return;
    if (last !== null) {
      const next = now + (stamp - last) / 1000 * data.rate * Number(speed.value);
      go(next > end ? 0 : next);
    }
    last = stamp;
    requestAnimationFrame(tick);
  };
  const play = (on) => {
    if (still) return;
    playing = on;
    last = null;
    button.textContent = on ? "Pause" : "Play";
    button.setAttribute("aria-pressed", String(on));
    if (on) requestAnimationFrame(tick);
  };

  const turn = (across, upwards) => {
    look.azimuth -= across;
    look.elevation = Math.max(-90, Math.min(90, look.elevation + upwards));
    draw();
  };
  const zoom = (factor) => { look.zoom = Math.max(0.1, Math.min(50, look.zoom * factor)); draw(); };
  const reset = () => { look = { azimuth: data.azimuth, elevation: data.elevation, zoom: 1 }; draw(); };

  const held = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    held.set(event.pointerId, event);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    if (!before) return;
    if (held.size === 1) turn((event.clientX - before.clientX) * 0.5, (event.clientY - before.clientY) * 0.5);
    if (held.size === 2) {
      const other = [...held.values()].find((item) => item.pointerId !== event.pointerId);
      const far = (item) => Math.hypot(item.clientX - other.clientX, item.clientY - other.clientY);
      if (far(before) > 0) zoom(far(event) / far(before));
    }
    held.set(event.pointerId, event);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => held.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-event.deltaY / 500));
  }, { passive: false });
  const keys = {
    ArrowLeft: () => turn(5, 0), ArrowRight: () => turn(-5, 0), ArrowUp: () => turn(0, 5), ArrowDown: () => turn(0, -5),
    "+": () => zoom(1.1), "=": () => zoom(1.1), "-": () => zoom(1 / 1.1), 0: reset, " ": () => play(!playing),
    ",": () => go(now - end / 100), ".": () => go(now + end / 100),
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  if (!still) {
    slider.addEventListener("input", () => { play(false); go(Number(slider.value) * end); });
    button.addEventListener("click", () => play(!playing));
  }
  trails.addEventListener("change", draw);
  element("motion-reset").addEventListener("click", reset);
  const again = () => { ink = colours(); draw(); };
  dark.addEventListener("change", again);
  addEventListener("resize", draw);
  addEventListener("beforeprint", draw);
  go(0);
  play(!reduced.matches);
})();
