// SPDX-License-Identifier: GPL-3.0-or-later
#include "view.hpp"

#ifdef STATEJUMP_HAS_VIEW
#include <GL/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ranges.hpp"

namespace statejump::dem {
namespace {

// This flag is private in YADE's own headers and public in the declared interface. An explicit
// instantiation ignores access rights, so it works with both.
bool& view_has_functors();

template <bool* flag>
struct PrivateFlag {
  friend bool& view_has_functors() { return *flag; }
};
template struct PrivateFlag<&yade::OpenGLRenderer::initDone>;

constexpr int sides = 96;
constexpr Real pi = 3.14159265358979323846;

// Restores YADE's drawing state, except for the matrix. YADE itself saves the matrix around each
// body, and OpenGL's matrix stack is short: after about thirty pictures it has room for only one
// more.
class Painter {
 public:
  Painter(const Vector3r& color, Real opacity) {
    glPushAttrib(GL_ENABLE_BIT | GL_CURRENT_BIT | GL_LINE_BIT | GL_POLYGON_BIT |
                 GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_LIGHTING_BIT);
    glDisable(GL_CULL_FACE);
    // Light both sides of a face alike, according to the given normal.
    glLightModeli(GL_LIGHT_MODEL_TWO_SIDE, GL_FALSE);
    glColorMaterial(GL_FRONT_AND_BACK, GL_AMBIENT_AND_DIFFUSE);
    glEnable(GL_COLOR_MATERIAL);
    if (opacity < 1) {
      glEnable(GL_BLEND);
      glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
      glDepthMask(GL_FALSE);
    }
    glColor4d(color.x(), color.y(), color.z(), opacity);
  }
  ~Painter() { glPopAttrib(); }
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;
};

std::array<Real, 2> on_circle(int i) {
  const Real angle = 2 * pi * i / sides;
  return {std::cos(angle), std::sin(angle)};
}

void circle(Real radius, Real z) {
  glBegin(GL_LINE_LOOP);
  for (int i = 0; i < sides; ++i) {
    const auto [c, s] = on_circle(i);
    glVertex3d(radius * c, radius * s, z);
  }
  glEnd();
}

// Draws a few lines on the cylinder, parallel to its axis, which make rotation visible.
void generators(Real radius, Real half_length, int count) {
  glBegin(GL_LINES);
  for (int i = 0; i < count; ++i) {
    const auto [c, s] = on_circle(i * sides / count);
    glVertex3d(radius * c, radius * s, -half_length);
    glVertex3d(radius * c, radius * s, half_length);
  }
  glEnd();
}

// Draws a cylinder wall. `sign` of the normal for lighting: 1 if seen from outside, -1 from inside.
void wall(Real radius, Real half_length, Real sign) {
  glBegin(GL_QUAD_STRIP);
  for (int i = 0; i <= sides; ++i) {
    const auto [c, s] = on_circle(i);
    glNormal3d(sign * c, sign * s, 0);
    glVertex3d(radius * c, radius * s, -half_length);
    glVertex3d(radius * c, radius * s, half_length);
  }
  glEnd();
}

// Draws a ring in the plane at height z, or a disc if the inner radius is 0.
void ring(Real inner, Real outer, Real z) {
  glBegin(GL_QUAD_STRIP);
  glNormal3d(0, 0, z < 0 ? -1 : 1);
  for (int i = 0; i <= sides; ++i) {
    const auto [c, s] = on_circle(i);
    glVertex3d(inner * c, inner * s, z);
    glVertex3d(outer * c, outer * s, z);
  }
  glEnd();
}

// Draws a sphere from its lowest point up to a polar angle [rad]. `sign` has the same meaning as in
// wall().
void sphere(Real radius, Real polar, Real sign) {
  constexpr int rings = 24;
  for (int k = 0; k < rings; ++k) {
    const Real lower = polar * k / rings;
    const Real upper = polar * (k + 1) / rings;
    glBegin(GL_QUAD_STRIP);
    for (int i = 0; i <= sides; ++i) {
      const auto [c, s] = on_circle(i);
      for (const Real angle : {lower, upper}) {
        const Vector3r out(std::sin(angle) * c, std::sin(angle) * s, -std::cos(angle));
        glNormal3d(sign * out.x(), sign * out.y(), sign * out.z());
        glVertex3d(radius * out.x(), radius * out.y(), radius * out.z());
      }
    }
    glEnd();
  }
}

// Three great circles, one perpendicular to each axis.
void great_circles(Real radius) {
  for (int axis = 0; axis < 3; ++axis) {
    glBegin(GL_LINE_LOOP);
    for (int i = 0; i < sides; ++i) {
      const auto [c, s] = on_circle(i);
      Vector3r point = Vector3r::Zero();
      point[(axis + 1) % 3] = radius * c;
      point[(axis + 2) % 3] = radius * s;
      glVertex3d(point.x(), point.y(), point.z());
    }
    glEnd();
  }
}

// Radius and position of a journal drawn with magnified play.
struct Drawn {
  Real radius;
  Vector3r shift;  // in the local axes of the journal
};

Drawn magnified(const Journal& journal, const yade::State& state) {
  Drawn drawn{journal.expanded(journal.radius), Vector3r::Zero()};
  Real scale = ViewSettings::clearance_scale();
  const auto& scene = yade::Omega::instance().getScene();
  if (scale == 1 || !scene) return drawn;
  const Bearing* nearest = nullptr;
  const yade::State* place = nullptr;
  Real least = std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < number_of_bodies(*scene); ++i) {
    const auto& body = body_at(*scene, i);
    const auto* bearing = body ? dynamic_cast<const Bearing*>(body->shape.get()) : nullptr;
    if (!bearing) continue;
    const Real distance = (body->state->se3.position - state.se3.position).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = bearing;
    place = body->state.get();
  }
  if (!nearest) return drawn;
  const Real bearing_radius = nearest->expanded(nearest->radius);
  const Real clearance = bearing_radius - drawn.radius;
  const Vector3r axis = place->se3.orientation * Vector3r::UnitZ();
  const Vector3r centres = state.se3.position - place->se3.position;
  const Vector3r offset = centres - centres.dot(axis) * axis;
  // A journal outside of every bearing is not magnified.
  if (!(clearance > 0) || offset.norm() > bearing_radius) return drawn;
  scale = std::min(scale, std::max<Real>(1, 0.7 * bearing_radius / clearance));
  drawn.radius = bearing_radius - scale * clearance;
  drawn.shift = state.se3.orientation.conjugate() * Vector3r((scale - 1) * offset);
  return drawn;
}

Real half_length_of(Real half_length, Real radius) {
  return half_length > 0 ? half_length : radius;
}

}  // namespace

void refresh_view() {
  view_has_functors() = false;
}

Real ViewSettings::clearance_scale_ = 1;

void ViewSettings::set_clearance_scale(Real scale) {
  if (!(scale >= 1 && std::isfinite(scale))) {
    refuse("Gl1_Journal", "clearanceScale", scale, "1 or above [-]");
  }
  clearance_scale_ = scale;
}

void draw(const Journal& journal, const yade::State& state, bool wire) {
  const Drawn drawn = magnified(journal, state);
  const Real half = half_length_of(journal.expanded(journal.halfLength), drawn.radius);
  const Painter painter(journal.color, 1);
  glTranslated(drawn.shift.x(), drawn.shift.y(), drawn.shift.z());
  if (!wire) {
    wall(drawn.radius, half, 1);
    ring(0, drawn.radius, half);
    ring(0, drawn.radius, -half);
  }
  glDisable(GL_LIGHTING);
  if (!wire) glColor3d(0, 0, 0);  // edges, and a mark that shows the rotation of the journal
  for (const Real z : {-half, half}) circle(drawn.radius, 1.001 * z);
  if (wire) generators(drawn.radius, half, 12);
  glBegin(GL_LINES);
  for (const Real z : {-half, half}) {
    glVertex3d(0, 0, 1.001 * z);
    glVertex3d(drawn.radius, 0, 1.001 * z);
  }
  glEnd();
}

void draw(const Bearing& bearing, const yade::State&, bool wire) {
  const Real inner = bearing.expanded(bearing.radius);
  const Real outer = 1.3 * inner;  // arbitrary, because the wall thickness is not modelled
  const Real half = half_length_of(bearing.expanded(bearing.halfLength), inner);
  {
    const Painter painter(bearing.color, 1);
    glDisable(GL_LIGHTING);
    for (const Real z : {-half, half}) {
      circle(inner, z);
      circle(outer, z);
    }
    generators(outer, half, 12);
  }
  if (wire) return;
  const Painter painter(bearing.color, 0.35);
  ring(inner, outer, -half);
  wall(outer, half, 1);
  ring(inner, outer, half);
}

void draw(const Ball& ball, const yade::State&, bool wire) {
  const Real radius = ball.expanded(ball.radius);
  const Painter painter(ball.color, 1);
  if (!wire) sphere(radius, pi, 1);
  glDisable(GL_LIGHTING);
  if (!wire) glColor3d(0, 0, 0);  // great circles show the rotation of the ball
  great_circles(1.001 * radius);
}

void draw(const Socket& socket, const yade::State&, bool wire) {
  // The drawing shows only the lower half, so that the inside is visible. The contact uses the
  // whole sphere.
  const Real radius = socket.expanded(socket.radius);
  {
    const Painter painter(socket.color, 1);
    glDisable(GL_LIGHTING);
    great_circles(radius);
  }
  if (wire) return;
  const Painter painter(socket.color, 0.35);
  sphere(radius, pi / 2, -1);
}

void draw(const MeshBore& bore, const yade::State&, bool wire) {
  if (!bore.mesh()) return;
  const geometry::BoreMesh& mesh = *bore.mesh();
  const geometry::Triangles& all = mesh.triangles();
  const Real grown = bore.expanded(1);
  const auto place = [&](const Vector3r& v) -> Vector3r {
    return mesh.centre() + grown * (v - mesh.centre());
  };
  constexpr std::size_t most = 20000;  // larger meshes are drawn as dots
  {
    const Painter edges(bore.color, 1);
    glDisable(GL_LIGHTING);
    glBegin(GL_LINES);
    for (const auto& edge : bore.rim()) {
      for (const int end : edge) {
        const Vector3r v = place(all.vertices[static_cast<std::size_t>(end)]);
        glVertex3d(v.x(), v.y(), v.z());
      }
    }
    glEnd();
  }
  const Painter painter(bore.color, wire ? 1 : 0.35);
  if (wire || all.faces.size() > most) {
    glDisable(GL_LIGHTING);
    const std::size_t stride = 1 + all.vertices.size() / most;
    glBegin(GL_POINTS);
    for (std::size_t i = 0; i < all.vertices.size(); i += stride) {
      const Vector3r v = place(all.vertices[i]);
      glVertex3d(v.x(), v.y(), v.z());
    }
    glEnd();
    return;
  }
  glBegin(GL_TRIANGLES);
  for (const auto& face : all.faces) {
    const Vector3r a = place(all.vertices[static_cast<std::size_t>(face[0])]);
    const Vector3r b = place(all.vertices[static_cast<std::size_t>(face[1])]);
    const Vector3r c = place(all.vertices[static_cast<std::size_t>(face[2])]);
    const Vector3r normal = (b - a).cross(c - a).normalized();
    glNormal3d(normal.x(), normal.y(), normal.z());
    for (const Vector3r& v : {a, b, c}) glVertex3d(v.x(), v.y(), v.z());
  }
  glEnd();
}

void draw(const Slider& slider, const yade::State&, bool wire) {
  // Both pads are parts of one sphere. The slider is drawn as the bounding box of this sphere.
  const Real half = slider.expanded(slider.radius);
  const Painter painter(slider.color, 1);
  if (wire) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  for (int axis = 0; axis < 3; ++axis) {
    for (const Real side : {-1.0, 1.0}) {
      Vector3r normal = Vector3r::Zero();
      normal[axis] = side;
      glBegin(GL_QUADS);
      glNormal3d(normal.x(), normal.y(), normal.z());
      for (const auto& [u, v] : {std::array<Real, 2>{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        Vector3r corner = normal;
        corner[(axis + 1) % 3] = u;
        corner[(axis + 2) % 3] = v;
        corner *= half;
        glVertex3d(corner.x(), corner.y(), corner.z());
      }
      glEnd();
    }
  }
}

void draw(const SlotFace& face, const yade::State&, bool wire) {
  const Vector3r center = face.expanded(face.distance) * face.normal;
  const Real half = face.halfSize > 0 ? face.halfSize : face.distance;
  const Vector3r other = std::abs(face.normal.x()) < 0.6 ? Vector3r::UnitX() : Vector3r::UnitY();
  const Vector3r u = half * face.normal.cross(other).normalized();
  const Vector3r v = face.normal.cross(u);
  const auto square = [&](GLenum mode) {
    glBegin(mode);
    glNormal3d(-face.normal.x(), -face.normal.y(), -face.normal.z());
    for (const Vector3r& corner : {Vector3r(center - u - v), Vector3r(center + u - v),
                                   Vector3r(center + u + v), Vector3r(center - u + v)}) {
      glVertex3d(corner.x(), corner.y(), corner.z());
    }
    glEnd();
  };
  {
    const Painter painter(face.color, 1);
    glDisable(GL_LIGHTING);
    square(GL_LINE_LOOP);
  }
  if (wire) return;
  const Painter painter(face.color, 0.35);
  square(GL_QUADS);
}

}  // namespace statejump::dem
#endif
