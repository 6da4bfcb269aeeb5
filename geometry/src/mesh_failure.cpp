// SPDX-License-Identifier: GPL-3.0-or-later
#include "statejump/geometry/mesh_failure.hpp"

#include <cstddef>
#include <cstdio>
#include <string_view>

namespace statejump::geometry {
namespace {

constexpr MeshReasonText of_format(const char* name, const char* cause) {
  return {name, MeshFault::unreadable, cause, "", true};
}

// In the order of MeshReason.
constexpr std::array<MeshReasonText, mesh_reason_count> texts{{
    // Files
    {"unknown_ending", MeshFault::unreadable, "a mesh file ends with .off, .stl, .ply or .obj"},
    {"not_a_file", MeshFault::unreadable, "is no regular file"},
    {"not_opened", MeshFault::unreadable, "cannot be opened"},
    {"above_2_gib", MeshFault::unreadable, "has more than 2 GiB"},
    {"read_failed", MeshFault::unreadable, "cannot be read"},
    {"empty_file", MeshFault::unreadable, "the file is empty"},
    // Texts and bytes of a format
    of_format("nothing_held", "it holds nothing"),
    of_format("wrong_first_word", "line {line} does not begin with {word}"),
    of_format("line_without_counts", "line {line} should hold the numbers of vertices and faces"),
    of_format("binary_off", "it is binary: only OFF as text is read"),
    of_format("counts_beyond_file",
              "it declares {vertices} vertices and {faces} faces, which do not fit into its "
              "{bytes} bytes"),
    of_format("ends_before_vertex", "it ends before its last vertex"),
    of_format("ends_before_face", "it ends before its last face"),
    of_format("line_without_coordinates", "line {line} has no three coordinates"),
    of_format("line_without_corner_count", "line {line} has no number of corners"),
    of_format("line_of_fewer_corners", "line {line} has fewer corners than it declares"),
    of_format("line_after_last_face", "line {line} follows the last of the faces that it declares"),
    of_format("neither_text_nor_binary", "it neither begins with solid nor has 84 bytes"),
    of_format("facets_of_other_length",
              "it declares {facets} facets, which take {needed_bytes} bytes, but it has {bytes}"),
    of_format("line_lacks_word", "line {line} lacks the word {word}"),
    of_format("line_outside_solid", "line {line} is outside of a solid"),
    of_format("line_out_of_place", "line {line} is out of place"),
    of_format("ends_inside_facet", "it ends inside a facet"),
    of_format("ends_before_endsolid", "it ends before endsolid"),
    of_format("corner_no_index", "line {line} has a corner that is no index of a vertex"),
    of_format("header_without_end", "its header has no end"),
    of_format("header_without_format", "its header names no format"),
    of_format("no_header_line", "line {line} is no line of a PLY header"),
    of_format("unknown_property_type", "line {line} has a property of no known type"),
    of_format("property_before_element", "line {line} has a property before any element"),
    of_format("element_twice", "line {line} declares an element for the second time"),
    of_format("element_without_properties", "its element {element} has no properties"),
    of_format("items_beyond_file",
              "it declares {items} items of an element, which do not fit into its {bytes} bytes"),
    of_format("element_missing", "it lacks the element vertex or face"),
    of_format("coordinate_missing", "its vertices lack a coordinate"),
    of_format("vertex_indices_missing", "its faces lack vertex_indices"),
    of_format("no_number", "its data hold what is no number"),
    of_format("no_whole_number", "its data hold a count or an index that is no whole number"),
    of_format("list_of_negative_length", "its data hold a list of negative length"),
    of_format("ends_before_element", "it ends before its last element"),
    of_format("more_than_declared", "it holds more than it declares"),
    // Faces
    {"no_faces", MeshFault::bad_faces, "the mesh has no faces"},
    {"no_triangles", MeshFault::bad_faces, "the mesh has no faces with three vertices"},
    {"no_such_corner", MeshFault::bad_faces,
     "face {face} has corner {corner}, but there are only {vertices} vertices"},
    {"vertex_not_finite", MeshFault::bad_faces, "vertex {vertex} is not finite"},
    {"vertex_too_far", MeshFault::bad_faces,
     "vertex {vertex} at {at_m} is too far away for any joint"},
    {"face_without_area", MeshFault::bad_faces,
     "face {face} (vertices {corners}) at {at_m} has no area"},
    {"edge_of_three_faces", MeshFault::bad_faces,
     "the edge between vertices {vertex} and {other_vertex} at {at_m} belongs to more than two "
     "faces ({faces})"},
    {"one_sided", MeshFault::bad_faces,
     "the faces have no common orientation (a one-sided surface)"},
    {"sheets_at_vertex", MeshFault::bad_faces,
     "at vertex {vertex} at {at_m} two sheets meet that share no edge"},
    {"several_parts", MeshFault::bad_faces,
     "the mesh has several parts: face {face} (vertices {corners}) at {at_m} is not connected to "
     "face 0"},
    {"faces_intersect", MeshFault::self_intersects,
     "faces {face} and {other_face} at {at_m} intersect[, and {more_pairs} more pairs]"},
    // Walls
    {"one_open_end", MeshFault::open,
     "the mesh has one open end, of {edges} edges around {at_m}, but a bore has two, or none when "
     "it is a closed ring"},
    {"holes", MeshFault::open,
     "the mesh has {holes} hole(s) beside the open end(s), the largest of {edges} edges around "
     "{at_m}"},
    {"body_inside_out", MeshFault::inside_out,
     "the closed mesh is inside out: its normals point into the body", "flip turns it"},
    {"wall_inside_out", MeshFault::inside_out,
     "the mesh is inside out: its normals point away from {target}, as that of face {face} at "
     "{at_m}",
     "flip turns it"},
    {"no_smooth_wall", MeshFault::no_bore,
     "the closed mesh has no bore: no smooth wall surrounds an axis"},
    {"surrounds_no_axis", MeshFault::no_bore,
     "the mesh is no bore: its faces do not surround an axis"},
    {"faces_no_centre", MeshFault::no_bore,
     "the mesh is no socket: its faces do not face a centre"},
    {"too_few_faces", MeshFault::no_bore, "too few faces point to {target}"},
    {"facets_too_coarse", MeshFault::too_coarse,
     "the facets are too coarse: they leave the surface between them open by {open_m:3} m, allowed "
     "is {allowed_m:3} m, a fiftieth of the mean radius; a cylinder needs 16 around"},
    {"radius_too_large", MeshFault::too_large,
     "the mean radius is {mean_radius_m} m, allowed is {smallest_m} to {largest_m} m: are the "
     "coordinates in millimetres?",
     "scale by 0.001"},
    {"radius_too_small", MeshFault::too_small,
     "the mean radius is {mean_radius_m} m, allowed is {smallest_m} to {largest_m} m: is the scale "
     "right?"},
}};

constexpr bool is_complete() {
  for (const MeshReasonText& text : texts)
    if (text.name == nullptr) return false;
  return true;
}
static_assert(is_complete(), "every reason has its texts");

std::string rounded(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value + 0.0);
  return text;
}

struct Shown {
  int digits;
  std::string operator()(double value) const { return rounded(value, digits); }
  std::string operator()(const std::string& text) const { return text; }
  std::string operator()(const std::array<double, 3>& at) const {
    return "(" + rounded(at[0], digits) + ", " + rounded(at[1], digits) + ", " +
           rounded(at[2], digits) + ") m";
  }
  template <class Integer>
  std::string operator()(Integer value) const {
    return std::to_string(value);
  }
};

/// Replaces the names in braces by fields.
/// @param[out] complete whether all fields exist
std::string filled(std::string_view text, const MeshFields& fields, bool& complete) {
  std::string result;
  complete = true;
  while (true) {
    const std::size_t start = text.find('{');
    result += text.substr(0, start);
    if (start == std::string_view::npos) return result;
    const std::size_t end = text.find('}', start);
    std::string_view name = text.substr(start + 1, end - start - 1);
    text.remove_prefix(end + 1);
    int digits = 6;
    if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) {
      digits = name[colon + 1] - '0';
      name = name.substr(0, colon);
    }
    bool found = false;
    for (const auto& [known, value] : fields) {
      if (known != name) continue;
      result += std::visit(Shown{digits}, value);
      found = true;
    }
    if (!found) result.append("{").append(name).append("}");
    complete = complete && found;
  }
}

std::string joined(const std::string& cause, const std::string& remedy) {
  if (remedy.empty()) return cause;
  return cause + (cause.back() == '?' ? " Then " : "; ") + remedy;
}

}  // namespace

const MeshReasonText& text_of(MeshReason reason) {
  return texts[static_cast<std::size_t>(reason)];
}

std::string cause_template(MeshReason reason) {
  const MeshReasonText& text = text_of(reason);
  return (text.of_format ? "not readable as {format}: " : "") + std::string(text.cause);
}

std::string cause(MeshReason reason, const MeshFields& fields) {
  const std::string whole = cause_template(reason);
  const std::string_view text = whole;
  const std::size_t open = text.find('[');
  bool complete = false;
  if (open == std::string_view::npos) return filled(text, fields, complete);
  const std::string begin = filled(text.substr(0, open), fields, complete);
  const std::size_t close = text.find(']');
  const std::string part = filled(text.substr(open + 1, close - open - 1), fields, complete);
  bool ignored = false;
  return begin + (complete ? part : "") + filled(text.substr(close + 1), fields, ignored);
}

MeshFailure::MeshFailure(std::string file, MeshReason reason, MeshFields fields)
    : std::runtime_error(file + ": " +
                         joined(geometry::cause(reason, fields), text_of(reason).remedy)),
      file_(std::move(file)),
      cause_(geometry::cause(reason, fields)),
      remedy_(text_of(reason).remedy),
      fields_(std::move(fields)),
      reason_name_(text_of(reason).name),
      fault_(text_of(reason).fault),
      reason_(reason) {}

}  // namespace statejump::geometry
