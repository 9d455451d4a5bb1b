// A film of the picture, as a WebM file to send.
const TYPE = "video/webm";

export const canFilm = () => typeof MediaRecorder !== "undefined" && MediaRecorder.isTypeSupported(TYPE);

export class Film {
  // Records what the canvas shows until `stop`, then calls `onFile` with the file.
  constructor(canvas, onFile) {
    const parts = [];
    this.recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: TYPE, videoBitsPerSecond: 6e6 });
    this.recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    this.recorder.addEventListener("stop", () => onFile(new Blob(parts, { type: TYPE })));
    this.recorder.start();
  }

  stop() {
    if (this.recorder.state !== "inactive") this.recorder.stop();
  }
}

// Save a file under a name, as a click on a link does.
export function download(file, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(file), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
