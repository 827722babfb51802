// Files that were dropped, as the server reads them: one take may be a folder.
import {call, request} from './calls';
import type {MotionFile, StoredTake} from './types';

export interface NamedFile { path: string; file: File }

// Everything in what was dropped, folders included.
export async function filesOf(transfer: DataTransfer): Promise<NamedFile[]> {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  if (entries.length === 0) return [...transfer.files].map((file) => ({path: file.name, file}));
  const files: NamedFile[] = [];
  const visit = async (entry: FileSystemEntry): Promise<void> => {
    if (entry.name.startsWith('.')) return;
    if (entry.isFile) {
      const file = await new Promise<File>((done, fail) => (entry as FileSystemFileEntry).file(done, fail));
      files.push({path: entry.fullPath.replace(/^\//, ''), file});
      return;
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) {  // it gives at most a hundred at a time
      const some = await new Promise<FileSystemEntry[]>((done, fail) => reader.readEntries(done, fail));
      if (some.length === 0) return;
      for (const child of some) await visit(child);
    }
  };
  for (const entry of entries) await visit(entry);
  return files;
}

// Sends the files and returns the id of the upload. progress: of the bytes, 0 to 1.
export async function sendFiles(files: NamedFile[], progress: (fraction: number) => void): Promise<string> {
  const {id} = await (await request('/studio/uploads', {method: 'POST'})).json() as {id: string};
  const total = files.reduce((sum, {file}) => sum + file.size, 0) || 1;
  let sent = 0;
  for (const {path, file} of files) {
    await request(`/studio/uploads/${id}?path=${encodeURIComponent(path)}`, {method: 'PUT', body: file});
    sent += file.size;
    progress(sent / total);
  }
  return id;
}

export async function readTake(uploadId: string, name: string): Promise<StoredTake> {
  const response = await request(`/studio/uploads/${uploadId}?name=${encodeURIComponent(name)}`, {method: 'POST'});
  return await response.json() as StoredTake;
}

export async function readMotion(modelId: string, source: {upload: string} | {sequence: string}): Promise<MotionFile> {
  const response = await request(`/studio/models/${modelId}/motion?${new URLSearchParams(source)}`, {method: 'POST'});
  return await response.json() as MotionFile;
}

// Whether the files are a motion and not a take.
export const isMotion = (files: NamedFile[]): boolean =>
  files.length === 1 && /\.(bvh|json)$/i.test(files[0]!.path);

export const createTraining = (sequenceIds: string[], name: string, options: object): Promise<{job: {id: string}}> =>
  call('JobService/CreateTrainingJob', {sequenceIds, modelName: name, options, requestId: crypto.randomUUID()});
