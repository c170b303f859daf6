"""Compares what js_reference has computed natively and for Windows: compare.py NATIVE WINDOWS, the folders of its files. All of them
must be the same to the bit.
"""
import pathlib
import sys


def main() -> None:
    native, windows = map(pathlib.Path, sys.argv[1:])
    files = sorted(file.name for file in native.iterdir())
    if not files or files != sorted(file.name for file in windows.iterdir()):
        sys.exit("both folders must have the same files")
    different = [name for name in files if (native / name).read_bytes() != (windows / name).read_bytes()]
    if different:
        sys.exit(f"these differ: {', '.join(different)}")
    print(f"{len(files)} files of results are the same to the bit")


main()
