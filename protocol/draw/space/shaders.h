/* The programs that run for each corner and each pixel of a picture, in GLSL 3.30. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_SPACE_SHADERS_H
#define TDM_DRAW_SPACE_SHADERS_H

#define SHADER_HEAD "#version 330 core\n"

/* Light from above the viewer's left shoulder, and from the sky more than from the ground: `light` has the brightness
 * of the ground, of the sky, and of the lamp. A normal of no length: no light, the colour as it is. */
#define SHADER_LIGHT                                                     \
  "uniform vec3 light, up;\n"                                            \
  "vec3 lit(vec3 color, vec3 n, vec3 toward) {\n"                        \
  "  if (dot(n, n) < 0.25) return color;\n"                              \
  "  n = normalize(n);\n"                                                \
  "  if (dot(n, toward) < 0.0) n = -n;\n"                                \
  "  vec3 lamp = normalize(vec3(-0.45, 0.6, 0.66));\n"                   \
  "  float b = mix(light.x, light.y, 0.5 + 0.5 * dot(n, up));\n"         \
  "  b += light.z * max(0.0, dot(n, lamp));\n"                           \
  "  float s = pow(max(0.0, dot(n, normalize(lamp + toward))), 40.0);\n" \
  "  return min(vec3(1.0), color * b + 0.25 * light.z * s);\n"           \
  "}\n"

/* ---- triangles and lines ---- */

static const char shader_mesh_vertex[] =
    SHADER_HEAD "layout(location = 0) in vec3 position;\n"
                "layout(location = 1) in vec3 normal;\n"
                "layout(location = 2) in vec4 color;\n"
                "uniform mat4 projection;\n"
                "uniform bool perspective;\n"
                "uniform float nearer;\n" /* lines lie this much in front of their surfaces */
                "out vec3 at, n;\n"
                "out vec4 c;\n"
                "void main() {\n"
                "  at = position; n = normal; c = color;\n"
                "  vec3 p = perspective ? position * (1.0 - nearer) : position + vec3(0.0, 0.0, nearer);\n"
                "  gl_Position = projection * vec4(p, 1.0);\n"
                "}\n";

/* What is translucent is less so where one looks along it. */
static const char shader_mesh_fragment[] =
    SHADER_HEAD SHADER_LIGHT "in vec3 at, n;\n"
                             "in vec4 c;\n"
                             "uniform bool perspective;\n"
                             "uniform float opacity;\n"
                             "layout(location = 0) out vec4 color;\n"
                             "void main() {\n"
                             "  vec3 toward = perspective ? -normalize(at) : vec3(0.0, 0.0, 1.0);\n"
                             "  float a = c.a;\n"
                             "  if (a < 1.0 && dot(n, n) > 0.25)\n"
                             "    a = mix(a, min(1.0, 2.2 * a), pow(1.0 - abs(dot(normalize(n), toward)), 2.0));\n"
                             "  color = vec4(lit(c.rgb, n, toward), a * opacity);\n"
                             "}\n";

/* ---- balls ---- */

/* A square in front of each ball that just covers what is seen of it. In perspective that is the cone around the ball:
 * it cuts the plane that touches the ball at its nearest point in a disc of radius (d - r) r / sqrt(d^2 - r^2). */
static const char shader_ball_vertex[] =
    SHADER_HEAD "layout(location = 0) in vec4 ball;\n"
                "layout(location = 1) in vec4 color;\n"
                "uniform mat4 projection;\n"
                "uniform bool perspective;\n"
                "out vec3 at;\n"
                "flat out vec4 b, c;\n"
                "void main() {\n"
                "  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;\n"
                "  vec3 right = vec3(1.0, 0.0, 0.0), up = vec3(0.0, 1.0, 0.0), toward = vec3(0.0, 0.0, 1.0);\n"
                "  float half_side = ball.w;\n"
                "  if (perspective) {\n"
                "    float d = length(ball.xyz);\n"
                "    toward = -ball.xyz / d;\n"
                "    right = normalize(cross(abs(toward.y) < 0.9 ? up : right, toward));\n"
                "    up = cross(toward, right);\n"
                "    half_side = d > ball.w ? (d - ball.w) * ball.w * inversesqrt(d * d - ball.w * ball.w) : 0.0;\n"
                "  }\n"
                "  at = ball.xyz + ball.w * toward + half_side * (corner.x * right + corner.y * up);\n"
                "  b = ball; c = color;\n"
                "  gl_Position = projection * vec4(at, 1.0);\n"
                "}\n";

/* Where the ray through the pixel meets the ball first, by the quadratic equation, with the root taken from the point
 * of the ray that is nearest to the middle: no digits are lost for small balls far away. */
static const char shader_ball_fragment[] =
    SHADER_HEAD "#extension GL_ARB_conservative_depth : enable\n" SHADER_LIGHT "in vec3 at;\n"
                "flat in vec4 b, c;\n"
                "uniform mat4 projection;\n"
                "uniform bool perspective;\n"
                "uniform float opacity;\n"
                "layout(location = 0) out vec4 color;\n"
                "#ifdef GL_ARB_conservative_depth\n"
                "layout(depth_greater) out float gl_FragDepth;\n"
                "#endif\n"
                "void main() {\n"
                "  vec3 ray = perspective ? normalize(at) : vec3(0.0, 0.0, -1.0);\n"
                "  vec3 m = b.xyz - at;\n"
                "  vec3 foot = at + dot(m, ray) * ray;\n"
                "  vec3 off = foot - b.xyz;\n"
                "  float h2 = b.w * b.w - dot(off, off);\n"
                "  if (h2 < 0.0) discard;\n"
                "  vec3 p = foot - sqrt(h2) * ray;\n"
                "  vec4 clip = projection * vec4(p, 1.0);\n"
                "  if (clip.z < -clip.w) discard;\n"
                "  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;\n"
                "  color = vec4(lit(c.rgb, (p - b.xyz) / b.w, -ray), c.a * opacity);\n"
                "}\n";

/* ---- the image ---- */

static const char shader_image_vertex[] =
    SHADER_HEAD "void main() {\n"
                "  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);\n"
                "}\n";

/* Four samples a pixel become one, and crevices get darker: where the surface on both sides of a point is nearer to the
 * viewer on the mean than the point itself. On a plane that mean is zero, however it is turned. */
static const char shader_image_fragment[] = SHADER_HEAD
    "uniform sampler2D image, depth;\n"
    "uniform mat4 projection;\n"
    "uniform bool perspective;\n"
    "uniform float reach, pixels, crevice;\n" /* of the look around [length], [pixels at z = 1]; how dark */
    "layout(location = 0) out vec4 color;\n"
    "float z_at(ivec2 p) {\n" /* nothing there: very far */
    "  float ndc = 2.0 * texelFetch(depth, p, 0).r - 1.0;\n"
    "  if (ndc == 1.0) return -1e9;\n"
    "  return perspective ? -projection[3][2] / (ndc + projection[2][2])\n"
    "                     : (ndc - projection[3][2]) / projection[2][2];\n"
    "}\n"
    "float rise(float z, float z0) {\n"
    "  float d = (z - z0) / reach;\n"
    "  return clamp(d, -1.0, 1.0) * (1.0 - smoothstep(1.0, 2.5, d));\n"
    "}\n"
    "void main() {\n"
    "  ivec2 size = textureSize(depth, 0), p = 2 * ivec2(gl_FragCoord.xy);\n"
    "  vec3 sum = vec3(0.0);\n"
    "  for (int s = 0; s < 4; s++) {\n"
    "    ivec2 q = p + ivec2(s & 1, s >> 1);\n"
    "    vec3 c = texelFetch(image, q, 0).rgb;\n"
    "    if (crevice > 0.0 && texelFetch(depth, q, 0).r < 1.0) {\n"
    "      float z0 = z_at(q), around = min(pixels / (perspective ? -z0 : 1.0), 120.0), dark = 0.0;\n"
    "      for (int k = 0; k < 5; k++) {\n"
    "        float angle = (float(k) + 0.25 * float(s)) * 0.628318, r = around * (0.25 + 0.75 * fract(0.618 * float(k "
    "+ s)));\n"
    "        ivec2 d = ivec2(round(r * vec2(cos(angle), sin(angle))));\n"
    "        float z1 = z_at(clamp(q + d, ivec2(0), size - 1)), z2 = z_at(clamp(q - d, ivec2(0), size - 1));\n"
    "        dark += max(0.0, 0.5 * (rise(z1, z0) + rise(z2, z0)));\n"
    "      }\n"
    "      c *= 1.0 - crevice * min(1.0, dark * 0.4);\n"
    "    }\n"
    "    sum += c;\n"
    "  }\n"
    "  color = vec4(0.25 * sum, 1.0);\n"
    "}\n";

/* The same without crevices, for flat views: a processor would go through their loop also where it has no effect. */
static const char shader_flat_fragment[] =
    SHADER_HEAD "uniform sampler2D image;\n"
                "layout(location = 0) out vec4 color;\n"
                "void main() {\n"
                "  ivec2 p = 2 * ivec2(gl_FragCoord.xy);\n"
                "  vec3 sum = texelFetch(image, p, 0).rgb + texelFetch(image, p + ivec2(1, 0), 0).rgb +\n"
                "             texelFetch(image, p + ivec2(0, 1), 0).rgb + texelFetch(image, p + ivec2(1, 1), 0).rgb;\n"
                "  color = vec4(0.25 * sum, 1.0);\n"
                "}\n";

#endif
