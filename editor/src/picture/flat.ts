// A picture without a graphics card: the same scene on a flat canvas, triangle by triangle, the farthest first.

import { BufferAttribute, Camera, Color, InstancedMesh, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial, Object3D, Scene, Vector3 } from "three";

const SUN = new Vector3(-0.4, 0.75, 0.55).normalize(); // as the eye has it
const SHADE = 0.55;

interface Piece {
  far: number;
  points: number[];
  colour: string;
  alpha: number;
}

export class Flat {
  private readonly pen: CanvasRenderingContext2D;
  private ratio = 1;
  private pieces: Piece[] = [];
  private readonly whole = new Matrix4();
  private readonly turned = new Matrix4();

  constructor(private readonly canvas: HTMLCanvasElement) {
    const pen = canvas.getContext("2d");
    if (!pen) throw new Error("no canvas");
    this.pen = pen;
  }

  setPixelRatio(ratio: number): void {
    this.ratio = ratio;
  }

  setSize(wide: number, tall: number, _style: boolean): void {
    this.canvas.width = Math.round(wide * this.ratio);
    this.canvas.height = Math.round(tall * this.ratio);
  }

  render(scene: Scene, camera: Camera): void {
    const { pen, canvas } = this;
    scene.updateMatrixWorld();
    camera.updateMatrixWorld();
    this.whole.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    this.pieces = [];
    const lines: Piece[] = [];
    scene.traverseVisible((object: Object3D) => {
      if (object instanceof InstancedMesh) {
        const own = new Matrix4();
        const colour = new Color(0xffffff);
        for (let k = 0; k < object.count; k += 1) {
          object.getMatrixAt(k, own);
          if (own.elements[0] === 0 && own.elements[5] === 0 && own.elements[1] === 0) continue;
          if (object.instanceColor) object.getColorAt(k, colour);
          this.solid(object, own.premultiply(object.matrixWorld), camera, colour);
        }
      } else if (object instanceof Mesh) this.solid(object, object.matrixWorld, camera, new Color(0xffffff));
      else if (object instanceof Line) lines.push(...this.strokes(object));
    });
    const back = scene.background instanceof Color ? scene.background.getStyle() : "#fff";
    pen.globalAlpha = 1;
    pen.fillStyle = back;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.lineWidth = Math.max(1, this.ratio);
    for (const one of lines) this.draw(one, false);
    pen.lineWidth = 0.6;
    for (const one of this.pieces.sort((a, b) => b.far - a.far)) this.draw(one, true);
  }

  private draw({ points, colour, alpha }: Piece, filled: boolean): void {
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.fillStyle = pen.strokeStyle = colour;
    pen.beginPath();
    for (let k = 0; k < points.length; k += 2) pen.lineTo(points[k]!, points[k + 1]!);
    if (filled) {
      pen.closePath();
      pen.fill();
    }
    if (!filled || alpha === 1) pen.stroke(); // no seams
  }

  /** Where a point is on the canvas, and how far; null behind the eye. */
  private seen(point: Vector3): [number, number, number] | null {
    const [x, y, z] = [point.x, point.y, point.z];
    const m = this.whole.elements;
    const w = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
    if (!(w > 1e-9)) return null;
    const [u, v] = [(m[0]! * x + m[4]! * y + m[8]! * z + m[12]!) / w, (m[1]! * x + m[5]! * y + m[9]! * z + m[13]!) / w];
    return [((u + 1) / 2) * this.canvas.width, ((1 - v) / 2) * this.canvas.height, w];
  }

  private solid(mesh: Mesh, place: Matrix4, camera: Camera, tint: Color): void {
    const { material, geometry } = mesh;
    if (!(material instanceof MeshLambertMaterial)) return; // shadows are left to graphics cards
    const at = geometry.getAttribute("position");
    const shades = material.vertexColors ? geometry.getAttribute("color") : null;
    const order = geometry.index;
    const colour = material.color.clone().multiply(tint);
    const inEye = this.turned.multiplyMatrices(camera.matrixWorldInverse, place);
    const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
    const count = order ? order.count : at.count;
    for (let k = 0; k < count; k += 3) {
      const numbers = [0, 1, 2].map((i) => (order ? order.getX(k + i) : k + i)) as [number, number, number];
      [a, b, c].forEach((point, i) => point.fromBufferAttribute(at as BufferAttribute, numbers[i]!).applyMatrix4(place));
      const found = [this.seen(a), this.seen(b), this.seen(c)];
      if (found.includes(null)) continue;
      const [p, q, r] = found as [number, number, number][] as [[number, number, number], [number, number, number], [number, number, number]];
      if ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) >= 0) continue; // seen from behind
      [a, b, c].forEach((point, i) => point.fromBufferAttribute(at as BufferAttribute, numbers[i]!).applyMatrix4(inEye));
      const normal = b.sub(a).cross(c.sub(a)).normalize();
      const light = (SHADE + (1 - SHADE) * Math.max(0, normal.dot(SUN))) * (shades ? shades.getX(numbers[0]) : 1);
      this.pieces.push({
        far: p[2] + q[2] + r[2],
        points: [p[0], p[1], q[0], q[1], r[0], r[1]],
        colour: colour.clone().multiplyScalar(light).getStyle(),
        alpha: material.transparent ? material.opacity : 1,
      });
    }
  }

  private strokes(line: Line): Piece[] {
    const at = line.geometry.getAttribute("position");
    const material = line.material as LineBasicMaterial;
    const shades = material.vertexColors ? line.geometry.getAttribute("color") : null;
    const { start, count } = line.geometry.drawRange;
    const point = new Vector3();
    const found: Piece[] = [];
    const step = line instanceof LineSegments ? 2 : 1;
    for (let k = start; k + 1 < Math.min(at.count, start + count); k += step) {
      const ends = [k, k + 1].map((i) => this.seen(point.fromBufferAttribute(at as BufferAttribute, i).applyMatrix4(line.matrixWorld)));
      const [p, q] = ends;
      if (!p || !q) continue;
      const colour = shades ? new Color(shades.getX(k), shades.getY(k), shades.getZ(k)) : material.color;
      found.push({ far: p[2] + q[2], points: [p[0], p[1], q[0], q[1]], colour: colour.getStyle(), alpha: 1 });
    }
    return found;
  }
}
