// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

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

/// Error for a mesh that is no bore or socket, as fields. what() is "file: cause; remedy", or
/// "file: cause? Then remedy" if the cause ends with a question.
class MeshFailure : public std::runtime_error {
 public:
  MeshFailure(std::string file, MeshFault fault, std::string cause, std::string remedy = "")
      : std::runtime_error(file + ": " + cause + joined(cause, remedy)),
        file_(std::move(file)),
        cause_(std::move(cause)),
        remedy_(std::move(remedy)),
        fault_(fault) {}

  const std::string& file() const { return file_; }  ///< file, or the name of the mesh
  const std::string& cause() const { return cause_; }
  const std::string& remedy() const { return remedy_; }  ///< in terms of BoreOptions; may be empty
  MeshFault fault() const { return fault_; }

 private:
  static std::string joined(const std::string& cause, const std::string& remedy) {
    if (remedy.empty()) return "";
    return (cause.back() == '?' ? " Then " : "; ") + remedy;
  }

  std::string file_;
  std::string cause_;
  std::string remedy_;
  MeshFault fault_;
};

}  // namespace statejump::geometry
