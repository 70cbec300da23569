// Sound of wind, grass and engines, made from noise and oscillators. It is off until someone asks for it: browsers allow sound only then, and so do people.
// The sound levels at the camera come from the client (`hearing.rs`). While the page is hidden, it is silent.

import { byId } from "./elements.js";

const UPDATE_MS = 100;
// Time in which a change is followed (s): short enough for gusts, too long for clicks.
const GLIDE_S = 0.15;
const NOISE_S = 5;
const DEFAULT_VOLUME = 50;
const SILENCE = { wind_m_per_s: 0, rustle: 0, engines: [] };
const KEY = "n";

export class Sound {
  // `hear()` returns the sound levels at the camera, or null; `volume` is that of the last visit or null; `remember(key, value)` stores it; `notify(text)` shows a line to
  // the user.
  constructor(hear, { volume, remember, notify }) {
    Object.assign(this, { hear, remember, notify });
    this.on = false;
    this.graph = null;
    const known = volume === null ? NaN : Number(volume);
    this.volume = known >= 0 && known <= 100 ? known : DEFAULT_VOLUME;
    byId("sounds").hidden = !window.AudioContext;
    if (window.AudioContext) this.listen();
  }

  listen() {
    byId("sound").addEventListener("click", () => this.toggle());
    byId("volume").value = this.volume;
    this.setVolume(this.volume);
    byId("volume").addEventListener("input", ({ target }) => {
      this.setVolume(Number(target.value));
      this.remember("volume", target.value);
    });
    addEventListener("keydown", (event) => {
      if (event.repeat || event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.("input, select")) return;
      if (event.key.toLowerCase() !== KEY || byId("prairie").inert) return;
      event.preventDefault();
      this.toggle();
    });
    document.addEventListener("visibilitychange", () => this.run());
  }

  toggle() {
    this.on = !this.on;
    try {
      if (this.on) this.graph ??= new Graph(this.volume);
    } catch (error) {
      this.fail(error);
    }
    byId("sound").setAttribute("aria-pressed", String(this.on));
    this.run();
  }

  // Some browsers have no sound device, or refuse one.
  fail({ message }) {
    this.on = false;
    byId("sound").setAttribute("aria-pressed", "false");
    this.notify(`No sound: ${message}`);
  }

  setVolume(volume) {
    this.volume = volume;
    byId("volume").setAttribute("aria-valuetext", `${volume} %`);
    this.graph?.setVolume(volume);
  }

  // Starts or stops the sound: it runs while it is on and the page is visible.
  run() {
    if (!this.graph) return;
    clearInterval(this.timer);
    const { context } = this.graph;
    const runs = this.on && !document.hidden;
    (runs ? context.resume() : context.suspend()).catch((error) => this.fail(error));
    if (!runs) return;
    this.timer = setInterval(() => this.update(), UPDATE_MS);
    this.update();
  }

  update() {
    this.graph.follow(this.hear() ?? SILENCE);
  }

  // What is played, for tests. `context` is "none" before the first request; `level` is the root mean square of what leaves the graph.
  report() {
    const { on, volume, graph } = this;
    if (!graph) return { on, volume, context: "none", level: 0, wind: null, rustle: null, engines: [] };
    return { on, volume, context: graph.context.state, level: graph.level(), ...graph.played };
  }
}

// The audio graph: noise through filters for wind and grass, two oscillators for each engine, one volume for all.
class Graph {
  constructor(volume) {
    this.context = new AudioContext({ latencyHint: "playback" });
    this.master = this.gain(0, this.context.destination);
    this.meter = this.context.createAnalyser();
    this.master.connect(this.meter);
    this.noise = this.context.createBufferSource();
    Object.assign(this.noise, { buffer: noise(this.context), loop: true });
    this.wind = this.band("bandpass", 0.6);
    this.rustle = this.band("highpass", 0.3);
    this.noise.start();
    this.engines = new Map();
    this.played = { wind: null, rustle: null, engines: [] };
    this.setVolume(volume);
  }

  // Perceived loudness grows about with the square root of the amplitude.
  setVolume(volume) {
    this.glide(this.master.gain, (volume / 100) ** 2);
  }

  // Plays the newest sound levels.
  follow({ wind_m_per_s, rustle, engines }) {
    // A stronger wind is louder and higher.
    const wind = { m_per_s: wind_m_per_s, gain: 0.9 * Math.min(wind_m_per_s / 20, 1) ** 1.5, hz: 180 + 35 * wind_m_per_s };
    const grass = { gain: 0.25 * rustle, hz: 3000 + 1500 * (1 - rustle) };
    for (const [band, { gain, hz }] of [[this.wind, wind], [this.rustle, grass]]) {
      this.glide(band.gain.gain, gain);
      this.glide(band.filter.frequency, hz);
    }
    const heard = new Set(engines.map(({ object }) => object));
    for (const [object, engine] of this.engines) {
      if (heard.has(object)) continue;
      engine.stop();
      this.engines.delete(object);
    }
    for (const engine of engines) {
      if (!this.engines.has(engine.object)) this.engines.set(engine.object, new Engine(this));
      this.engines.get(engine.object).follow(engine);
    }
    this.played = { wind, rustle: grass, engines };
  }

  // Root mean square of the newest samples.
  level() {
    const samples = new Float32Array(this.meter.fftSize);
    this.meter.getFloatTimeDomainData(samples);
    return Math.sqrt(samples.reduce((sum, sample) => sum + sample * sample, 0) / samples.length);
  }

  // The noise through a filter and a gain.
  band(type, q) {
    const gain = this.gain(0);
    const filter = this.filter(type, q, gain);
    this.noise.connect(filter);
    return { filter, gain };
  }

  filter(type, q, target) {
    const filter = this.context.createBiquadFilter();
    filter.type = type;
    filter.Q.value = q;
    filter.connect(target);
    return filter;
  }

  gain(value, target = this.master) {
    const gain = this.context.createGain();
    gain.gain.value = value;
    gain.connect(target);
    return gain;
  }

  glide(parameter, value) {
    parameter.setTargetAtTime(value, this.context.currentTime, GLIDE_S);
  }
}

// One engine: a saw and a square wave an octave below, dulled by a filter; a rotor beats.
class Engine {
  constructor(graph) {
    this.graph = graph;
    const { context } = graph;
    this.pan = context.createStereoPanner();
    this.pan.connect(graph.master);
    this.loudness = graph.gain(0, this.pan);
    this.beats = graph.gain(1, this.loudness);
    this.filter = graph.filter("lowpass", 0.7, this.beats);
    this.high = this.oscillator("sawtooth", this.filter);
    this.low = this.oscillator("square", this.filter);
    this.beat = this.oscillator("sine", graph.gain(0.5, this.beats.gain));
  }

  follow({ loudness, pitch_hz, beat_hz, pan }) {
    const { graph } = this;
    graph.glide(this.loudness.gain, 0.22 * loudness);
    graph.glide(this.high.frequency, pitch_hz);
    graph.glide(this.low.frequency, pitch_hz / 2);
    graph.glide(this.filter.frequency, 6 * pitch_hz);
    graph.glide(this.pan.pan, 0.8 * pan);
    graph.glide(this.beat.frequency, beat_hz);
  }

  stop() {
    this.graph.glide(this.loudness.gain, 0);
    const end = this.graph.context.currentTime + 6 * GLIDE_S;
    for (const oscillator of [this.high, this.low, this.beat]) oscillator.stop(end);
    this.high.onended = () => this.pan.disconnect();
  }

  oscillator(type, target) {
    const oscillator = this.graph.context.createOscillator();
    oscillator.type = type;
    oscillator.frequency.value = 0;
    oscillator.connect(target);
    oscillator.start();
    return oscillator;
  }
}

// Noise whose energy falls with the frequency like that of wind. It is repeated, so its ends are faded into each other.
function noise(context) {
  const { sampleRate } = context;
  const length = NOISE_S * sampleRate;
  const overlap = Math.round(0.2 * sampleRate);
  const raw = new Float32Array(length + overlap);
  let slow = 0;
  for (let i = 0; i < raw.length; i++) {
    const white = 2 * Math.random() - 1;
    slow += 0.02 * (white - slow);
    raw[i] = 0.3 * white + 2 * slow;
  }
  const buffer = context.createBuffer(1, length, sampleRate);
  const samples = buffer.getChannelData(0);
  samples.set(raw.subarray(0, length));
  for (let i = 0; i < overlap; i++) {
    const share = i / overlap;
    samples[i] = Math.sqrt(share) * raw[i] + Math.sqrt(1 - share) * raw[length + i];
  }
  return buffer;
}
