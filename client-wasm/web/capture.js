// Pictures and films of the canvas, saved as files that are named after scene and view.

// The first that the browser can record is taken.
const FILMS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
const FILM_BITS_PER_S = 16e6;
const FILM_FRAMES_PER_S = 60;

export class Capture {
  // `state()` is the client's account of itself; `tell(text)` shows a line to the visitor; `filming(seconds)` is called about once a second, with null at the end.
  constructor(client, canvas, { state, tell, filming }) {
    Object.assign(this, { client, canvas, state, tell, filming });
    this.recorder = null;
  }

  // The canvas's newest picture in its full size: a PNG and its name.
  async shoot() {
    const name = this.name("png");
    return { name, blob: await this.drawn() };
  }

  // Saves a picture.
  async picture() {
    try {
      const { name, blob } = await this.shoot();
      save(blob, name);
      const [width, height] = this.state().picture_px;
      this.tell(`Picture saved: ${width} × ${height} px.`);
    } catch (error) {
      this.tell(`No picture: ${error.message}`);
    }
  }

  // Begins a film, or ends and saves it.
  film() {
    if (this.recorder) this.recorder.stop();
    else this.record();
  }

  record() {
    const type = window.MediaRecorder && this.canvas.captureStream && FILMS.find((film) => MediaRecorder.isTypeSupported(film));
    if (!type) return this.tell("This browser cannot film a canvas. Chrome, Edge and Firefox can.");
    const name = this.name(type.startsWith("video/mp4") ? "mp4" : "webm");
    const parts = [];
    const begun = performance.now();
    const recorder = new MediaRecorder(this.canvas.captureStream(FILM_FRAMES_PER_S), { mimeType: type, videoBitsPerSecond: FILM_BITS_PER_S });
    const seconds = () => (performance.now() - begun) / 1000;
    const counting = setInterval(() => this.filming(seconds()), 500);
    recorder.ondataavailable = ({ data }) => data.size && parts.push(data);
    recorder.onerror = ({ error }) => this.tell(`The film ended: ${error?.message ?? "the browser could not go on"}.`);
    recorder.onstop = () => {
      clearInterval(counting);
      for (const track of recorder.stream.getTracks()) track.stop();
      this.recorder = null;
      this.client.keep_drawing(false);
      this.filming(null);
      if (!parts.length) return this.tell("No film: the browser recorded nothing.");
      save(new Blob(parts, { type }), name);
      this.tell(`Film saved: ${seconds().toFixed(1)} s.`);
    };
    this.client.keep_drawing(true);
    recorder.start(1000);
    this.recorder = recorder;
    this.filming(0);
  }

  // Draws, and takes the picture in the same task: later the canvas need not have it any more.
  drawn() {
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
