// A film of the views as WebM, where the browser records. Its time is that of the clock: where frames come
// too late, the film is as slow as they were.
import type {Viewport} from './viewport';

const kTypes = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'];
const kWaitMs = 5000;  // for one frame

export const filmType = (): string | undefined =>
  typeof MediaRecorder === 'undefined' ? undefined : kTypes.find((type) => MediaRecorder.isTypeSupported(type));

export interface Film { numFrames: number; fps: number; show(frame: number): void; shown(frame: number): boolean }

export async function recordFilm(viewport: Viewport, film: Film): Promise<Blob> {
  const type = filmType();
  if (!type) throw new Error('This browser does not record films; export the frames instead.');
  const stream = viewport.stream(film.fps), recorder = new MediaRecorder(stream, {mimeType: type, videoBitsPerSecond: 8e6});
  const parts: Blob[] = [];
  recorder.ondataavailable = (event) => parts.push(event.data);
  const ended = new Promise<void>((done, fail) => {
    recorder.onstop = () => done();
    recorder.onerror = () => fail(new Error('The browser stopped recording.'));
  });
  await arrive(film, 0);
  recorder.start();
  const start = performance.now();
  for (let frame = 0; frame < film.numFrames; ++frame) {
    if (frame > 0) await arrive(film, frame);
    viewport.redraw();
    await until(() => performance.now() >= start + 1e3 * (frame + 1) / film.fps, kWaitMs);
  }
  recorder.stop();
  await ended;
  for (const track of stream.getTracks()) track.stop();
  return new Blob(parts, {type});
}

async function arrive(film: Film, frame: number): Promise<void> {
  film.show(frame);
  if (!await until(() => film.shown(frame), kWaitMs)) throw new Error(`Frame ${frame} did not come, so there is no film.`);
}
async function until(holds: () => boolean, mostMs: number): Promise<boolean> {
  const end = performance.now() + mostMs;
  while (!holds()) {
    if (performance.now() > end) return false;
    await new Promise(requestAnimationFrame);
  }
  return true;
}
