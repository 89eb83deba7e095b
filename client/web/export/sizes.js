// Sizes of files in words.

/** "1.2 MB". Pure. */
export function sizeText(bytes) {
  const [unit, size] = bytes >= 1e9 ? ['GB', 1e9] : bytes >= 1e6 ? ['MB', 1e6] : ['kB', 1e3];
  const number = bytes / size;
  return `${number >= 100 ? Math.round(number) : Number(number.toPrecision(2))} ${unit}`;
}
