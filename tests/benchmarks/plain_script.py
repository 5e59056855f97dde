"""What one would write in an afternoon: pymunk at 60 Hz, cv2 drawing, mp4v.  `pipeline` measures against it.

python plain_script.py scene.json out.mp4 [seconds]
"""

from __future__ import annotations

import json
import math
import sys

import cv2
import numpy as np
import pymunk
from pymunk.autogeometry import convex_decomposition

WIDTH, HEIGHT, FPS = 1280, 720, 60
COLORS = [(170, 119, 68), (119, 102, 238), (51, 136, 34), (68, 187, 204), (238, 204, 102), (119, 51, 170)]


def main() -> None:
    with open(sys.argv[1]) as f:
        scene = json.load(f)
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 10.0
    space = pymunk.Space()
    space.gravity = tuple(scene["gravity"])
    bodies = {}
    drawn = []
    for k, b in enumerate(scene["bodies"]):
        shape, anchored = b["shape"], b.get("anchored", False)
        if shape["type"] == "rectangle":
            w, h = shape["size"]
            outline = [(-w / 2, -h / 2), (w / 2, -h / 2), (w / 2, h / 2), (-w / 2, h / 2)]
        else:
            outline = [tuple(p) for p in shape.get("vertices", [])]
        body = pymunk.Body(body_type=pymunk.Body.STATIC if anchored else pymunk.Body.DYNAMIC)
        body.position, body.angle = tuple(b["position"]), b.get("angle", 0.0)
        if shape["type"] == "circle":
            shapes = [pymunk.Circle(body, shape["radius"])]
        else:
            area = sum(
                p[0] * q[1] - p[1] * q[0] for p, q in zip(outline, outline[1:] + outline[:1], strict=True)
            )
            ring = outline if area > 0 else outline[::-1]
            shapes = [pymunk.Poly(body, part) for part in convex_decomposition([*ring, ring[0]], 0.001)]
        for s in shapes:
            s.density, s.friction, s.elasticity = 1.0, b.get("friction", 0.5), b.get("elasticity", 0.3)
        space.add(body, *shapes)
        if not anchored:
            body.velocity = tuple(b.get("velocity", (0, 0)))
            body.angular_velocity = b.get("angular_velocity", 0)
        bodies[b["id"]] = body
        drawn.append((body, shape, np.array(outline), COLORS[k % len(COLORS)]))
    for j in scene.get("joints", []):
        a, b = (space.static_body if name is None else bodies[name] for name in j["bodies"])
        joint = pymunk.PivotJoint(a, b, tuple(j["position"]))
        joint.collide_bodies = False
        space.add(joint)
    scale = (scene.get("view") or {}).get("pixels_per_metre", 100.0)
    video = cv2.VideoWriter(sys.argv[2], cv2.VideoWriter_fourcc(*"mp4v"), FPS, (WIDTH, HEIGHT))
    for frame in range(round(seconds * FPS)):
        picture = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
        for body, shape, outline, color in drawn:
            if shape["type"] == "circle":
                x, y = (round(body.position.x * scale), round(-body.position.y * scale))
                r = round(shape["radius"] * scale)
                cv2.circle(picture, (x, y), r, color, -1, cv2.LINE_AA)
                cv2.circle(picture, (x, y), r, (40, 40, 40), 2, cv2.LINE_AA)
                end = (round(x + r * math.cos(body.angle)), round(y - r * math.sin(body.angle)))
                cv2.line(picture, (x, y), end, (40, 40, 40), 2, cv2.LINE_AA)
            else:
                c, s = math.cos(body.angle), math.sin(body.angle)
                world = outline @ np.array([[c, s], [-s, c]]) + body.position
                points = np.rint(world * (scale, -scale)).astype(np.int32)
                cv2.fillPoly(picture, [points], color, cv2.LINE_AA)
                cv2.polylines(picture, [points], True, (40, 40, 40), 2, cv2.LINE_AA)
        text = f"{frame / FPS:.1f} s"
        cv2.putText(picture, text, (20, 40), cv2.FONT_HERSHEY_SIMPLEX, 0.8, (40, 40, 40), 2, cv2.LINE_AA)
        video.write(picture)
        space.step(1 / FPS)
    video.release()


if __name__ == "__main__":
    main()
