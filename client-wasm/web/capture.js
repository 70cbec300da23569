// Pictures and videos of the canvas, saved as files named after scene and view.

// Video formats in order of preference.
const FORMATS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
const VIDEO_BITS_PER_S = 16e6;
const VIDEO_FRAMES_PER_S = 60;
// The browser keeps a video in memory until it is saved: eight minutes at the rate above.
const VIDEO_BYTES = 1e9;

export class Capture {
  // `state()` returns the client's state; `notify(text)` shows a line to the user; `recording(seconds)` is called twice a second, and with null at the end.
  constructor(client, canvas, { state, notify, recording }) {
    Object.assign(this, { client, canvas, state, notify, recording });
    this.recorder = null;
  }

  // The newest frame at full size: a PNG and its file name.
  async shoot() {
    const name = this.name("png");
    return { name, blob: await this.png() };
  }

  // Saves a picture.
  async picture() {
    try {
      const { name, blob } = await this.shoot();
      save(blob, name);
      const [width, height] = this.state().picture_px;
      this.notify(`Picture saved: ${width} × ${height} px.`);
    } catch (error) {
      this.notify(`No picture saved: ${error.message}`);
    }
  }

  // Starts a video, or ends and saves it.
  video() {
    if (this.recorder) this.recorder.stop();
    else this.record();
  }

  record() {
    const type = window.MediaRecorder && this.canvas.captureStream && FORMATS.find((format) => MediaRecorder.isTypeSupported(format));
    if (!type) return this.notify("This browser cannot record a canvas. Chrome, Edge and Firefox can.");
    const name = this.name(type.startsWith("video/mp4") ? "mp4" : "webm");
    const parts = [];
    let bytes = 0;
    const started = performance.now();
    let recorder;
    try {
      recorder = new MediaRecorder(this.canvas.captureStream(VIDEO_FRAMES_PER_S), { mimeType: type, videoBitsPerSecond: VIDEO_BITS_PER_S });
      recorder.start(1000);
    } catch (error) {
      return this.notify(`No video: ${error.message}`);
    }
    const seconds = () => (performance.now() - started) / 1000;
    const timer = setInterval(() => this.recording(seconds()), 500);
    recorder.ondataavailable = ({ data }) => {
      if (!data.size) return;
      parts.push(data);
      bytes += data.size;
      if (bytes > VIDEO_BYTES && recorder.state === "recording") recorder.stop();
    };
    recorder.onerror = ({ error }) => this.notify(`The recording stopped: ${error?.message ?? "the browser gave no reason"}.`);
    recorder.onstop = () => {
      clearInterval(timer);
      for (const track of recorder.stream.getTracks()) track.stop();
      this.recorder = null;
      this.client.draw_every_frame(false);
      this.recording(null);
      if (!parts.length) return this.notify("No video saved: the browser recorded nothing.");
      save(new Blob(parts, { type }), name);
      this.notify(`Video saved: ${seconds().toFixed(1)} s.`);
    };
    this.client.draw_every_frame(true);
    this.recorder = recorder;
    this.recording(0);
  }

  // Draws and reads the canvas in the same task, since the canvas may be cleared after it.
  png() {
    return new Promise((resolve, reject) => {
      const attempt = () => {
        if (!this.client.redraw()) return requestAnimationFrame(attempt);
        this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the browser cannot encode the canvas"))), "image/png");
      };
      attempt();
    });
  }

  name(ending) {
    const { scene_name: scene, view } = this.state();
    return `prairie-${scene}-${view.replaceAll(",", "_")}.${ending}`.replaceAll(/[^\w.-]/g, "-");
  }
}

function save(blob, name) {
  const anchor = document.createElement("a");
  anchor.href = URL.createObjectURL(blob);
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), 60_000);
}
