// What the edited animation is taken away as.
import {dialog, element} from './dom';

const kTitles: Record<string, string> = {
  glb: 'Binary glTF, a morph target for each frame (.glb)', abc: 'Alembic (.abc)', usda: 'USD text (.usda)',
  pc2: 'Point cache (.pc2), positions alone', mdd: 'Point cache (.mdd), positions alone', obj: 'The mesh of a point cache (.obj)',
  npz: 'NumPy arrays (.npz)', npy: 'One NumPy array (.npy)', pseq: 'Pleat sequence (.pseq)', bvh: 'The motion as BVH (.bvh)',
  'character.glb': 'The character as glTF: skin, motion, folds as morph targets (.glb)', 'character.usda': 'The character as USD: skin and motion (.usda)',
  webm: 'A film of the views (.webm)',
  json: 'The motion as JSON (.json)', png: 'A picture of the view (.png)',
};

export async function askExport(formats: readonly string[], name: string): Promise<{format: string; name: string} | null> {
  const select = element('select', {id: 'export-format'}, ...formats.map((format) =>
    element('option', {value: format}, kTitles[format] ?? format)));
  const input = element('input', {id: 'export-name', value: `${name.replace(/[^\w.-]+/g, '_')}_edited`, maxlength: 100});
  const chosen = await dialog('Take the animation away', [element('label', {}, 'As', select), element('label', {}, 'File name', input)], 'Export');
  return chosen ? {format: select.value, name: input.value.trim() || 'edited'} : null;
}
