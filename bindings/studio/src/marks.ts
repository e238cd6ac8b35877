// Signs on the photo: places of warnings, and lamps that were taken out.

export interface Mark {
  at: [number, number];
  text: string;
  isMain: boolean;
}

/** A cross on a lamp that was taken out. */
export function drawCross(context: CanvasRenderingContext2D, [x, y]: [number, number], half: number): void {
  for (const [colour, wide] of [
    ["#000", 0.5],
    ["#fff", 0.25],
  ] as const) {
    context.strokeStyle = colour;
    context.lineWidth = wide * half;
    context.beginPath();
    context.moveTo(x - half, y - half);
    context.lineTo(x + half, y + half);
    context.moveTo(x + half, y - half);
    context.lineTo(x - half, y + half);
    context.stroke();
  }
}

/** A sign at a place of the photo: the main one, where one more stroke helps most, is larger and says so. */
export function drawMark(context: CanvasRenderingContext2D, mark: Mark, scale: number): void {
  const [x, y] = mark.at;
  const unit = 1 / scale;
  const radius = (mark.isMain ? 13 : 10) * unit;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = mark.isMain ? "#ffffff" : "#1c1c1ccc";
  context.fill();
  context.lineWidth = 2.5 * unit;
  context.strokeStyle = mark.isMain ? "#1c1c1c" : "#ffffff";
  context.stroke();
  context.fillStyle = mark.isMain ? "#1c1c1c" : "#ffffff";
  context.font = `bold ${(mark.isMain ? 16 : 12) * unit}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(mark.text, x, y + unit);
}
