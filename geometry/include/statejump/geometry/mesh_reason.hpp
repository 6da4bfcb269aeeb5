// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace statejump::geometry {

/// Reason why a mesh is rejected, in more detail than its MeshFault. Names are public and do not
/// change.
enum class MeshReason : unsigned char {
  // Files
  unknown_ending,
  not_a_file,
  not_opened,
  above_2_gib,
  read_failed,
  empty_file,
  // Texts and bytes of a format
  nothing_held,
  wrong_first_word,
  line_without_counts,
  binary_off,
  counts_beyond_file,
  ends_before_vertex,
  ends_before_face,
  line_without_coordinates,
  line_without_corner_count,
  line_of_fewer_corners,
  line_after_last_face,
  neither_text_nor_binary,
  facets_of_other_length,
  line_lacks_word,
  line_outside_solid,
  line_out_of_place,
  ends_inside_facet,
  ends_before_endsolid,
  corner_no_index,
  header_without_end,
  header_without_format,
  no_header_line,
  unknown_property_type,
  property_before_element,
  element_twice,
  element_without_properties,
  items_beyond_file,
  element_missing,
  coordinate_missing,
  vertex_indices_missing,
  no_number,
  no_whole_number,
  list_of_negative_length,
  ends_before_element,
  more_than_declared,
  // Faces
  no_faces,
  no_triangles,
  no_such_corner,
  vertex_not_finite,
  vertex_too_far,
  face_without_area,
  edge_of_three_faces,
  one_sided,
  sheets_at_vertex,
  several_parts,
  faces_intersect,
  // Walls
  one_open_end,
  holes,
  body_inside_out,
  wall_inside_out,
  no_smooth_wall,
  surrounds_no_axis,
  faces_no_centre,
  too_few_faces,
  facets_too_coarse,
  radius_too_large,
  radius_too_small,
};

constexpr int mesh_reason_count = static_cast<int>(MeshReason::radius_too_small) + 1;

}  // namespace statejump::geometry
