// Starting a compression: how far a vertex may be off is promised, and checked by the server.
import {call} from '../api/calls';
import type {Sequence} from '../api/types';
import {dialog, element} from './dom';

// Whether a job was started.
export async function askCompression(take: Sequence): Promise<boolean> {
  const millimeters = element('input', {type: 'number', id: 'compress-mm', min: .001, max: 1e6, step: 'any', value: .5, required: true});
  const form = [element('label', {}, 'No vertex of any frame is further off than, mm', millimeters),
    element('p', {class: 'soft'}, 'The server checks the promise. The file plays here and wherever Pleat is, from any frame.')];
  if (!await dialog(`Compress ${take.name}`, form, 'Compress')) return false;
  await call('JobService/CreateCompressionJob', {sequenceId: take.id, options: {maxErrorMm: Number(millimeters.value)}, requestId: crypto.randomUUID()});
  return true;
}
