// How a measured surface is drawn.
import { kColorShader } from './color_scale';

export const kVertexShader = `
  in vec2 place;
  in float value;
  out vec3 vPoint, vNormal;
  centroid out vec2 vPlace; // not beyond the triangle, where the texels of another chart may be
  out float vValue;
  void main() {
    vPoint = position;
    vNormal = normalMatrix * normal;
    vPlace = place;
    vValue = value;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }
`;

// Values between texels are interpolated for the picture; a texel without a value stays as it is. `look`: defines
// vec3 lookHere(inout vec3 n), the colour before it is lit, and the normal.
export const partShader = (look: string) => `
  precision highp float;
  precision highp sampler2D;
  uniform sampler2D values;
  uniform bool byVertex, showBacks, faded;
  uniform vec4 cut;
  uniform vec3 cutColor;
  in vec3 vPoint, vNormal;
  centroid in vec2 vPlace;
  in float vValue;
  out vec4 outColor;
  ${kColorShader}

  float valueAt(ivec2 at) { return texelFetch(values, clamp(at, ivec2(0), textureSize(values, 0) - 1), 0).r; }
  float valueHere() {
    if (byVertex) return vValue;
    ivec2 nearest = ivec2(floor(vPlace));
    float value = valueAt(nearest);
    if (value > 1e38) return value;
    vec2 corner = floor(vPlace - 0.5), part = vPlace - 0.5 - corner;
    float sum = 0.0, weight = 0.0;
    for (int k = 0; k < 4; ++k) {
      ivec2 step = ivec2(k & 1, k >> 1);
      float v = valueAt(ivec2(corner) + step);
      if (v > 1e38) continue;
      vec2 w = mix(1.0 - part, part, vec2(step));
      sum += w.x * w.y * v, weight += w.x * w.y;
    }
    return weight > 0.0 ? sum / weight : value;
  }
  vec3 lookOfValue() {
    float value = valueHere();
    return value > 1e38 ? noValue : colorOf(value);
  }
  ${look}

  void main() {
    if (dot(cut.xyz, vPoint) > cut.w) discard;
    if (!gl_FrontFacing && !showBacks) {  // the inside of a body that is cut open
      float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0));
      outColor = vec4(cutColor * (0.92 + 0.08 * stripe), 1.0);
      return;
    }
    vec3 n = normalize(vNormal);
    vec3 color = faded ? vec3(0.8) : lookHere(n);
    float light = 0.62 + 0.38 * abs(n.z) + 0.08 * n.y;
    outColor = vec4(color * min(light, 1.0), 1.0);
  }
`;
