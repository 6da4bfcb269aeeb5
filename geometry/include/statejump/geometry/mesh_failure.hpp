// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "statejump/geometry/mesh_reason.hpp"

namespace statejump::geometry {

/// Defect of a mesh.
enum class MeshFault : unsigned char {
  unreadable,  ///< the file cannot be opened or is not of its format
  bad_faces,   ///< missing or degenerate faces, an edge of three faces, inconsistent orientation,
               ///< several parts
  self_intersects,  ///< faces pass through each other
  open,             ///< no open ends, or holes
  inside_out,       ///< normals point away from the axis or centre
  no_bore,          ///< the faces surround no axis or face no centre
  too_coarse,       ///< too few facets to determine the true surface
  too_large,        ///< mean radius above the largest
  too_small         ///< mean radius below the smallest
};

/// Name of the enumerator, e.g. "unreadable".
inline const char* to_string(MeshFault fault) {
  switch (fault) {
    case MeshFault::unreadable:
      return "unreadable";
    case MeshFault::bad_faces:
      return "bad_faces";
    case MeshFault::self_intersects:
      return "self_intersects";
    case MeshFault::open:
      return "open";
    case MeshFault::inside_out:
      return "inside_out";
    case MeshFault::no_bore:
      return "no_bore";
    case MeshFault::too_coarse:
      return "too_coarse";
    case MeshFault::too_large:
      return "too_large";
    case MeshFault::too_small:
      return "too_small";
  }
  return "unknown";
}

/// Texts of a reason, as templates. Names in braces stand for fields of the failure.
struct MeshReasonText {
  const char* name;  ///< the enumerator's
  MeshFault fault;
  const char* cause;  ///< a part in brackets is left out if its field is missing
  const char* remedy = "";
  bool of_format = false;  ///< the cause follows "not readable as {format}: "
};

/// The texts of a reason; the only place with its wording.
const MeshReasonText& text_of(MeshReason reason);

/// The whole template of a cause.
std::string cause_template(MeshReason reason);

/// A position is in m.
using MeshValue =
    std::variant<std::int64_t, std::uint64_t, double, std::string, std::array<double, 3>>;

/// Name and value of what the cause names.
using MeshFields = std::vector<std::pair<std::string, MeshValue>>;

/// The cause, with the fields in place of their names.
std::string cause(MeshReason reason, const MeshFields& fields);

/// Error for a mesh that is no bore or socket, with its data as fields. what() is "file: cause;
/// remedy", or "file: cause? Then remedy" if the cause is a question.
class MeshFailure : public std::runtime_error {
 public:
  MeshFailure(std::string file, MeshReason reason, MeshFields fields = {});

  const std::string& file() const { return file_; }  ///< file, or the name of the mesh
  const std::string& cause() const { return cause_; }
  const std::string& remedy() const { return remedy_; }  ///< in terms of BoreOptions; may be empty
  MeshFault fault() const { return fault_; }
  MeshReason reason() const { return reason_; }
  const char* reason_name() const { return reason_name_; }
  const MeshFields& fields() const { return fields_; }

 private:
  std::string file_;
  std::string cause_;
  std::string remedy_;
  MeshFields fields_;
  const char* reason_name_;
  MeshFault fault_;
  MeshReason reason_;
};

}  // namespace statejump::geometry
