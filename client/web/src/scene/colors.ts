// Colors of numbers. The map is turbo (Mikhailov 2019) by the table of lib/render/src/color_scale.cpp, so
// that the page and the command line show the same number in the same color.
export type Rgb = [number, number, number];

export const kTurboTable: readonly Rgb[] = [
  [48, 18, 59], [66, 88, 201], [65, 144, 254], [27, 196, 226], [38, 236, 166], [124, 254, 91], [195, 241, 52],
  [244, 199, 58], [252, 139, 37], [217, 56, 6], [122, 4, 3]];

// fraction: 0 to 1, beyond it the ends.
export function turbo(fraction: number): Rgb {
  const place = Math.min(1, Math.max(0, fraction)) * (kTurboTable.length - 1);
  const i = Math.min(Math.floor(place), kTurboTable.length - 2), t = place - i;
  return kTurboTable[i]!.map((from, c) => (from + t * (kTurboTable[i + 1]![c]! - from)) / 255) as Rgb;
}

// Colors that differ for each joint, by the golden angle.
export function jointColor(joint: number): Rgb {
  const hue = joint * 137.508 % 360, [s, l] = [.55, .6];
  const channel = (n: number): number => {
    const k = (n + hue / 30) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [channel(0), channel(8), channel(4)];
}

export const toLinear = (c: number): number => c <= .04045 ? c / 12.92 : ((c + .055) / 1.055) ** 2.4;
