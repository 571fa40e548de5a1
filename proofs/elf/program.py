"""A board's program: its bytes where they are while it runs, its functions by name, and where its structures have their fields."""
import re

from elftools.elf.elffile import ELFFile


class Field:
    """Where a field is and how wide: bytes from the structure's beginning; of an enumeration without fields, the number of each word."""

    def __init__(self, at, die):
        self.at, self.size = at, die.attributes["DW_AT_byte_size"].value
        self.words = {child.attributes["DW_AT_name"].value.decode(): child.attributes["DW_AT_const_value"].value
                      for child in die.iter_children() if child.tag == "DW_TAG_enumerator"}


class NoFunction(LookupError):
    """A function that the compiler put into its callers, or more than one of that name."""


class Program:
    def __init__(self, path, functions):
        """`functions`: a file with a line a function, `address size path`, the path as Rust's source has it: one compiler mangles names
        in one way, another in another."""
        self.elf = ELFFile(open(path, "rb"))
        self.sections = []
        for section in self.elf.iter_sections():
            # Writable data change while the program runs, so their bytes in the file are left out. Code that start-up copies to
            # fast memory is in a writable section too, but does not change.
            loaded = section["sh_flags"] & 2 and section["sh_type"] == "SHT_PROGBITS"
            writable, executable = section["sh_flags"] & 1, section["sh_flags"] & 4
            if loaded and (not writable or executable):
                self.sections.append((section["sh_addr"], bytearray(section.data())))
        self.functions = []
        for line in open(functions, encoding="utf-8"):
            address, size, path = line.rstrip("\n").split(" ", 2)
            self.functions.append((path, (int(address, 16), int(size))))
        self._types = None

    def found(self, at, size):
        for start, data in self.sections:
            if start <= at and at + size <= start + len(data):
                return data, at - start
        return None, None

    def code(self, at):
        for size in (4, 2):
            data, offset = self.found(at, size)
            if data is not None:
                return bytes(data[offset:offset + size])
        raise KeyError(f"no code at {at:#x}")

    def word(self, at):
        data, offset = self.found(at, 4)
        return None if data is None else int.from_bytes(data[offset:offset + 4], "little")

    def patched(self, at, code):
        """Other bytes in the place of some."""
        data, offset = self.found(at, len(code))
        before = bytes(data[offset:offset + len(code)])
        data[offset:offset + len(code)] = code
        return before

    def function(self, pattern):
        """The one function whose path fits. A path of the older mangling does not say for which type: two places are two functions."""
        fitting = {place for path, place in self.functions if re.search(pattern, path)}
        if len(fitting) != 1:
            raise NoFunction(f"{len(fitting)} functions are called {pattern}")
        return fitting.pop()

    # Layout of structures.

    def structure(self, name):
        """The description of a type, by its whole name."""
        if self._types is None:
            self._types = {}
            for unit in self.elf.get_dwarf_info().iter_CUs():
                for die in unit.iter_DIEs():
                    if die.tag in ("DW_TAG_structure_type", "DW_TAG_enumeration_type") and "DW_AT_name" in die.attributes:
                        # The debug information describes a variant of an enumeration as a structure inside the enumeration's
                        # structure. Such a variant is no type of its own.
                        if "DW_AT_byte_size" in die.attributes and die.get_parent().tag != "DW_TAG_structure_type":
                            self._types.setdefault(die.attributes["DW_AT_name"].value.decode(), die)
        return self._types[name]

    def fields(self, die, at=0, prefix=""):
        """All fields of a structure that are numbers, by their path: `state.force`. Of an enumeration, its number."""
        members = [child for child in die.iter_children() if child.tag == "DW_TAG_member"]
        named = lambda child: child.attributes["DW_AT_name"].value.decode()
        inner = [child for child in members if "DW_AT_name" in child.attributes]
        if die.tag != "DW_TAG_structure_type" or not inner:
            field = Field(at, die)
            return {prefix: field} if field.size else {}
        found = {}
        for child in inner:
            name = named(child)
            # The only field of a newtype has the path of the newtype itself.
            path = prefix if name in ("__0", "bits") else f"{prefix}.{name}".lstrip(".")
            place = at + child.attributes["DW_AT_data_member_location"].value
            found |= self.fields(child.get_DIE_from_attribute("DW_AT_type"), place, path)
        return found

    def size(self, name):
        return self.structure(name).attributes["DW_AT_byte_size"].value

    def variants(self, name):
        """Of an enumeration with fields: its number of each variant, and the variant's description. `None`: any other number."""
        die = self.structure(name)
        part = next(child for child in die.iter_children() if child.tag == "DW_TAG_variant_part")
        found = {}
        for variant in part.iter_children():
            if variant.tag != "DW_TAG_variant":
                continue
            value = variant.attributes.get("DW_AT_discr_value")
            member = next(child for child in variant.iter_children() if child.tag == "DW_TAG_member")
            label = member.attributes["DW_AT_name"].value.decode()
            found[label] = (value.value if value else None, member.get_DIE_from_attribute("DW_AT_type"))
        return found
