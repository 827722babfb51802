// What leaves the page: the edited animation in the formats of other programs, pictures, films, and files
// of the server.
import {request, save} from './api/calls';
import {askExport} from './panels/exporting';
import {say} from './panels/dom';
import {filmType, recordFilm} from './scene/film';
import type {Studio} from './studio';

export class TakingAway {
  constructor(private readonly studio: Studio) {}

  async ask(): Promise<void> {
    const {document, viewport, about} = this.studio;
    if (!document.model || !document.motion) return;
    const choice = await askExport([...about.formats, 'json', 'png', ...(filmType() ? ['webm'] : [])], document.model.name);
    if (!choice) return;
    const {format, name} = choice, file = `${name}.${format.split('.').at(-1)!}`;
    if (format === 'png') return save(await viewport.picture(), file);
    if (format === 'webm') return save(await this.film(), file);
    const motion = JSON.stringify(document.motionFile());
    if (format === 'json') return save(new Blob([motion], {type: 'application/json'}), file);
    say(`Writing ${file}…`);
    save(await this.animation(format, motion), file);
  }
  async animation(format: string, motion = JSON.stringify(this.studio.document.motionFile())): Promise<Blob> {
    return (await request(`/studio/models/${this.studio.document.model!.id}/export?format=${format}`,
      {method: 'POST', headers: {'Content-Type': 'application/json'}, body: motion})).blob();
  }
  // The views as they are shown, from the first frame to the last.
  async film(): Promise<Blob> {
    const {studio} = this, shown = studio.document.frame;
    studio.stop();
    try {
      return await recordFilm(studio.viewport, {numFrames: studio.document.numFrames, fps: studio.document.fps,
        show: (frame) => {
          studio.seek(frame);
          studio.hint(`Recording frame ${frame + 1} of ${studio.document.numFrames}…`);
        }, shown: (frame) => studio.isShown(frame)});
    } finally {
      studio.seek(shown);
      studio.hint('');
    }
  }
  async download(method: string, id: string, name: string): Promise<void> {
    const response = await request(`/rpc/${method}`, {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({id})});
    save(await response.blob(), name);
  }
}
