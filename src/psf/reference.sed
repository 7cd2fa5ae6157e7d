# Makes the comments of a header those that Doxygen reads, line by line. The first line is the file's, and a comment
# at the end of a line is that of what stands before it.
1s@^// @/// \\file \\ilinebr @
s@^ *// clang-format o.*@@
s@^// ----.*@@
s@^\( *\)//\( \|$\)@\1///\2@
s@^\( *[^ /}].*\)  // @\1  ///< @
