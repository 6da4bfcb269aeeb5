# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads YADE's libraries as x86-64 ELF files: sizes of objects, virtual function tables, stored names."""
from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from pathlib import Path

_IDENTIFIER = re.compile(rb"[A-Za-z_]\w{0,59}\0")
_RELOCATION_TO_SYMBOL, _RELOCATION_TO_ADDRESS = 1, 8  # R_X86_64_64, R_X86_64_RELATIVE


@dataclass
class Symbol:
    """A dynamic symbol; address 0 if the library only requires it."""

    name: str
    address: int
    size: int  # [byte]
    defined: bool


def _text(data: bytes, start: int) -> str:
    return data[start: data.index(b"\0", start)].decode("latin1")


class Library:
    """One shared library."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = path.read_bytes()
        if self.data[:5] != b"\x7fELF\x02":
            raise ValueError(f"{path} is no 64-bit ELF file")
        table, = struct.unpack_from("<Q", self.data, 0x28)
        size, count, names = struct.unpack_from("<HHH", self.data, 0x3A)
        headers = [struct.unpack_from("<IIQQQQIIQQ", self.data, table + i * size) for i in range(count)]
        names_at = headers[names][4]
        # name: address, place in the file, size
        self.sections = {_text(self.data, names_at + one[0]): (one[3], one[4], one[5]) for one in headers}
        self.mapped = [(one[3], one[4], one[5]) for one in headers if one[3] and one[1] != 8]
        self.symbols = self._read_symbols()
        self.by_name = {one.name: one for one in self.symbols if one.defined}
        self.by_address: dict[int, list[str]] = {}
        for one in self.by_name.values():
            self.by_address.setdefault(one.address, []).append(one.name)
        self._relocations: dict[int, tuple[int, int, int]] | None = None

    def _read_symbols(self) -> list[Symbol]:
        _, strings, _ = self.sections[".dynstr"]
        _, start, size = self.sections[".dynsym"]
        result = []
        for name, _, _, section, address, length in struct.iter_unpack("<IBBHQQ", self.data[start: start + size]):
            result.append(Symbol(_text(self.data, strings + name), address, length, section != 0))
        return result

    def bytes_at(self, address: int, size: int) -> bytes:
        """Return the bytes that the library has at a load address; empty if nothing is loaded there."""
        for begin, place, length in self.mapped:
            if begin <= address < begin + length:
                return self.data[place + address - begin: place + min(address - begin + size, length)]
        return b""

    def build_id(self) -> str:
        """Return the GNU build identifier; empty if there is none."""
        _, place, size = self.sections.get(".note.gnu.build-id", (0, 0, 0))
        return self.data[place + 16: place + size].hex()

    def relocations(self) -> dict[int, tuple[int, int, int]]:
        """Return kind, symbol and addend by address."""
        if self._relocations is None:
            _, place, size = self.sections[".rela.dyn"]
            self._relocations = {address: (info & 0xFFFFFFFF, info >> 32, addend) for address, info, addend
                                 in struct.iter_unpack("<QQq", self.data[place: place + size])}
        return self._relocations


class Libraries:
    """All libraries of a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.files = [Library(path) for path in sorted(folder.glob("lib*.so"))]

    def build_ids(self) -> dict[str, str]:
        """Return the build identifiers of the three libraries that the plugin is linked with."""
        return {one.path.name: one.build_id() for one in self.files
                if one.path.name in ("libyade.so", "libpkg_common.so", "libpkg_dem.so")}

    def find(self, name: str) -> tuple[Library, Symbol] | None:
        """Return the first library that defines a symbol."""
        for library in self.files:
            if name in library.by_name:
                return library, library.by_name[name]
        return None

    def allocated_size(self, class_name: str) -> int | None:
        """Return the size [bytes] that Create<Class> passes to operator new.

        The size is the operand of the last ``mov edi, constant`` before the first call.
        """
        found = self.find(f"_ZN4yade{len(class_name) + 6}Create{class_name}Ev")
        if not found:
            return None
        code = found[0].bytes_at(found[1].address, 96)
        begin = code.find(b"\xbf")
        if begin < 0 or b"\xe8" not in code[begin + 5: begin + 32]:
            return None
        return int.from_bytes(code[begin + 1: begin + 5], "little")

    def table(self, class_name: str) -> list[str]:
        """Return the entries of the virtual function table of a class of YADE."""
        found = self.find(f"_ZTVN4yade{len(class_name)}{class_name}E")
        return self.entries(*found) if found else []

    @staticmethod
    def entries(library: Library, symbol: Symbol) -> list[str]:
        """Return the entries of a virtual function table: symbols, or numbers where no symbol exists."""
        entries = []
        for address in range(symbol.address, symbol.address + symbol.size, 8):
            kind, index, addend = library.relocations().get(address, (0, 0, 0))
            if kind == _RELOCATION_TO_SYMBOL:
                entries.append(library.symbols[index].name)
            elif kind == _RELOCATION_TO_ADDRESS:
                entries.append(min(library.by_address.get(addend, ["(without a name)"])))
            else:
                entries.append(str(struct.unpack("<q", library.bytes_at(address, 8))[0]))
        return entries

    def stored_names(self, class_name: str) -> list[str]:
        """Return the names under which O.save writes the members of a class to XML.

        The code of Boost.Serialization for the class loads the address of each name. If the compiler moved the code out
        of line, the first call leads to it.
        """
        found = self.find("_ZNK5boost7archive6detail11oserializerINS0_12xml_oarchiveEN4yade"
                          f"{len(class_name)}{class_name}EE16save_object_dataERNS1_14basic_oarchiveEPKv")
        if not found:
            return []
        library, symbol = found
        names = self._names_in_code(library, symbol.address, symbol.size)
        code = library.bytes_at(symbol.address, symbol.size)
        for i in range(len(code) - 5):
            if code[i] not in (0xE8, 0xE9):
                continue
            target = symbol.address + i + 5 + int.from_bytes(code[i + 1: i + 5], "little", signed=True)
            first, _, length = library.sections[".text"]
            if first <= target < first + length and target not in library.by_address:
                following = [one for one in library.by_address if target < one <= target + 9000]
                names |= self._names_in_code(library, target, min(following, default=target + 9000) - target)
                break
        return sorted(names - {class_name})

    @staticmethod
    def _names_in_code(library: Library, address: int, size: int) -> set[str]:
        code = library.bytes_at(address, size)
        first, place, length = library.sections[".rodata"]
        names = set()
        for i in range(len(code) - 7):
            # lea register, [rip + offset]
            if code[i] not in (0x48, 0x4C) or code[i + 1] != 0x8D or code[i + 2] & 0xC7 != 0x05:
                continue
            target = address + i + 7 + int.from_bytes(code[i + 3: i + 7], "little", signed=True)
            if first <= target < first + length:
                match = _IDENTIFIER.match(library.data, place + target - first)
                if match:
                    names.add(match[0][:-1].decode())
        return names

    def forces_offset(self) -> int | None:
        """Return the offset of the forces in a scene, which ForceResetter::action adds to the address of the scene."""
        found = self.find("_ZN4yade13ForceResetter6actionEv")
        if not found:
            return None
        code = found[0].bytes_at(found[1].address, found[1].size)
        # add register, small constant; or lea rdi, [register + small constant]
        match = re.search(rb"\x48\x83[\xc0-\xc7](.)|[\x48\x49]\x8d[\x78-\x7f](.)", code, re.S)
        return (match[1] or match[2])[0] if match else None

    def missing_symbols(self, plugin: Path) -> list[str]:
        """Return the symbols of YADE that a built plugin requires but that no library on this machine defines."""
        mine = Library(plugin)
        return sorted(one.name for one in mine.symbols
                      if not one.defined and "4yade" in one.name and not self.find(one.name))
