"""The writing of a map: its layout, partial file and journal, going on with them, and the final name.

What touches a file before it is finished belongs here; what reads finished files, and words about places, to
`fastlink.io`.
"""
