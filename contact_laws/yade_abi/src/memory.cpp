// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <stdexcept>

namespace statejump::yade_abi {

Memory::Memory() {
  if (pipe2(ends_, O_CLOEXEC | O_NONBLOCK) != 0) throw std::runtime_error("no pipe can be opened");
}

Memory::~Memory() {
  close(ends_[0]);
  close(ends_[1]);
}

bool Memory::copy(const void* from, void* to, std::size_t bytes) const {
  const auto written = write(ends_[1], from, bytes);
  if (written <= 0) return false;
  // If an unreadable page follows, some bytes may have been written before it. Read them to empty
  // the pipe.
  std::vector<char> taken(static_cast<std::size_t>(written));
  const bool whole = read(ends_[0], taken.data(), taken.size()) == written && taken.size() == bytes;
  if (whole) std::memcpy(to, taken.data(), bytes);
  return whole;
}

std::optional<Word> Memory::word(Word address) const {
  Word value;
  if (!copy(reinterpret_cast<const void*>(address), &value, sizeof value)) return std::nullopt;
  return value;
}

std::optional<std::string> Memory::text(Word address) const {
  constexpr std::size_t longest = 4096;
  std::string result;
  std::array<char, 64> part;
  // The text is copied in parts that end at page boundaries, because the page after the text may be
  // unreadable.
  while (result.size() < longest) {
    const std::size_t bytes = part.size() - address % part.size();
    if (!copy(reinterpret_cast<const void*>(address), part.data(), bytes)) return std::nullopt;
    if (const void* end = std::memchr(part.data(), 0, bytes)) {
      return result.append(part.data(),
                           static_cast<std::size_t>(static_cast<const char*>(end) - part.data()));
    }
    result.append(part.data(), bytes);
    address += bytes;
  }
  return std::nullopt;
}

std::string mangled_name(const std::string& class_name) {
  return std::to_string(class_name.size()) + class_name;
}

const void* symbol(const std::string& name) {
  return dlsym(RTLD_DEFAULT, name.c_str());
}

const void* own_symbol(const std::string& name) {
  // Searched only once, because dladdr is slow.
  static void* const module = []() -> void* {
    Dl_info info;
    if (!dladdr(reinterpret_cast<const void*>(&own_symbol), &info)) return nullptr;
    return dlopen(info.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
  }();
  return module ? dlsym(module, name.c_str()) : nullptr;
}

Word table_pointer(const std::string& class_name) {
  const void* table = symbol("_ZTVN4yade" + mangled_name(class_name) + "E");
  return table ? address_of(table) + 2 * sizeof(void*) : 0;
}

}  // namespace statejump::yade_abi
